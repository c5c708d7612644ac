// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_camera.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/unified_sphere.h"
#include "rig_text.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <set>
#include <sstream>
#include <vector>

namespace engram::cameras {
namespace {

constexpr double kLongestSide = 1e5;  // [px]

/// The values of such a file by name; every miss is an error that names file and key.
class YamlFile {
 public:
  explicit YamlFile(const std::string& path) : path_(path) {
    std::string text = readCalibrationFile(path);
    const bool isXml = text.starts_with("<?xml");
    if (!isXml && !text.starts_with("%YAML")) text = "%YAML:1.0\n---\n" + withoutDocumentMarks(text);
    // OpenCV reads for ever what does not begin with a key and goes on after that.
    if (!isXml && !beginsWithKey(text)) fail("is no calibration: it does not begin with a key");
    try {
      if (!file_.open(text, cv::FileStorage::READ | cv::FileStorage::MEMORY)) fail("cannot be read as YAML");
    } catch (const cv::Exception& e) {
      fail("is not YAML that can be read (" + e.err + ")");
    } catch (const std::exception&) {  // of a key without a name
      fail("is not YAML that can be read");
    }
    if (!file_.root().isMap()) fail("holds no keys with values");
  }

  [[noreturn]] void fail(const std::string& what) const { throw base::ConfigError(path_ + ": " + what); }

  /// The first of these keys that is there; an empty node otherwise.
  cv::FileNode find(std::initializer_list<const char*> keys) const {
    for (const char* key : keys)
      if (const cv::FileNode node = file_[key]; !node.empty()) return node;
    return {};
  }
  /// The numbers of a list, or of the `data` of a matrix.
  std::vector<double> list(std::initializer_list<const char*> keys) const {
    const cv::FileNode node = find(keys), data = node.isMap() ? node["data"] : node;
    std::vector<double> values;
    for (std::size_t i = 0; data.isSeq() && i < data.size(); ++i) {
      const cv::FileNode item = data[static_cast<int>(i)];
      values.push_back(isNumber(item) ? static_cast<double>(item) : std::nan(""));
      if (!std::isfinite(values.back())) fail(std::string(*keys.begin()) + ": not all of it is numbers");
    }
    return values;
  }
  std::vector<double> list(std::initializer_list<const char*> keys, std::size_t wanted) const {
    auto values = list(keys);
    if (values.size() != wanted)
      fail(std::string(*keys.begin()) + ": expected " + std::to_string(wanted) + " numbers, found " +
           std::to_string(values.size()));
    return values;
  }
  std::optional<double> number(std::initializer_list<const char*> keys) const {
    const cv::FileNode node = find(keys);
    if (isNumber(node)) return static_cast<double>(node);
    if (const auto values = list(keys); values.size() == 1) return values[0];
    return std::nullopt;
  }
  std::string word(const char* key) const {
    const cv::FileNode node = file_[key];
    return node.isString() ? static_cast<std::string>(node) : std::string();
  }

 private:
  static bool isNumber(const cv::FileNode& node) { return node.isInt() || node.isReal(); }

  /// Whether the first line that is no comment, directive or mark is `key: …`.
  static bool beginsWithKey(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.find_first_not_of(" \t\r") == std::string::npos || line.starts_with('#') ||
          line.starts_with('%') || line.starts_with("---"))
        continue;
      const auto end = std::find_if_not(line.begin(), line.end(), [](unsigned char c) {
        return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '-');
      });
      return end != line.begin() && end != line.end() && *end == ':';
    }
    return false;
  }

  /// What is echoed of ROS ends in `---`, and OpenCV reads one document.
  static std::string withoutDocumentMarks(const std::string& text) {
    const std::size_t from = text.starts_with("---\n") ? 4 : 0;
    const std::size_t to = text.find("\n---", from);
    return text.substr(from, to == std::string::npos ? to : to + 1 - from);
  }

  std::string path_;
  cv::FileStorage file_;
};

cv::Size toSize(const YamlFile& file, double width, double height) {
  for (const double side : {width, height})
    if (!(side >= 1 && side <= kLongestSide))
      file.fail("the images it is for have no size that a camera has");
  return {static_cast<int>(width), static_cast<int>(height)};
}

cv::Size readSize(const YamlFile& file) {
  if (!file.find({"resolution"}).empty()) {
    const auto size = file.list({"resolution"}, 2);
    return toSize(file, size[0], size[1]);
  }
  const auto width = file.number({"image_width", "width"}), height = file.number({"image_height", "height"});
  if (!width || !height) file.fail("image_width and image_height are missing: for which size is it?");
  return toSize(file, *width, *height);
}

void readDistortion(const YamlFile& file, ImagePlaneParams& plane) {
  static const std::set<std::string> kKnown{"",       "plumb_bob", "rational_polynomial", "radial-tangential",
                                            "radtan", "none"};
  const std::string camera = file.word("camera_model"), model = file.word("distortion_model");
  const bool isKnownCamera = camera.empty() || camera == "pinhole";
  const auto d = file.list({"distortion_coefficients", "D", "d", "distortion_coeffs"});
  const bool hasMore = d.size() > 5 && std::any_of(d.begin() + 5, d.end(), [](double k) { return k != 0; });
  if (!isKnownCamera || !kKnown.contains(model) || hasMore)
    file.fail("camera_model " + base::quoted(camera.empty() ? "pinhole" : camera) +
              " with distortion_model " + base::quoted(hasMore ? "rational_polynomial" : model) +
              "; only pinhole with radial-tangential (k1 k2 p1 p2 k3) can be used. For a fisheye calibrate a "
              "unified sphere: engram-rawlog calibrate --model unified");
  if (d.empty()) return;
  if (d.size() < 4)
    file.fail("distortion_coefficients: expected 4 numbers or more, found " + std::to_string(d.size()));
  plane.k1 = d[0], plane.k2 = d[1], plane.p1 = d[2], plane.p2 = d[3];
  plane.k3 = d.size() > 4 ? d[4] : 0;
}

ImagePlaneParams readPlane(const YamlFile& file) {
  ImagePlaneParams plane;
  if (!file.find({"intrinsics"}).empty()) {
    const auto k = file.list({"intrinsics"}, 4);
    plane.fx = k[0], plane.fy = k[1], plane.cx = k[2], plane.cy = k[3];
  } else {
    const auto k = file.list({"camera_matrix", "K", "k", "Camera_Matrix"}, 9);
    plane.fx = k[0], plane.skew = k[1], plane.cx = k[2], plane.fy = k[4], plane.cy = k[5];
  }
  if (plane.fx == 0 || plane.fy == 0) file.fail("the focal length is 0: the camera was never calibrated");
  readDistortion(file, plane);
  return plane;
}

std::optional<Eigen::Isometry3d> readMount(const YamlFile& file) {
  if (file.find({"T_BS"}).empty()) return std::nullopt;
  const auto t = file.list({"T_BS"}, 16);
  const Eigen::Matrix4d M = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(t.data());
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  if (!(R * R.transpose()).isIdentity(1e-3)) file.fail("T_BS is not a pose");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  T.translation() = M.topRightCorner<3, 1>();
  return T;
}

void readRectification(const YamlFile& file, YamlCamera& camera) {
  const auto R = file.list({"rectification_matrix", "R", "r"}),
             P = file.list({"projection_matrix", "P", "p"});
  if (R.size() != 9 || P.size() != 12 || P[0] == 0) return;
  camera.R_rectified_cam = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  camera.baseline = -P[3] / P[0];
}

}  // namespace

YamlCamera readYamlCamera(const std::string& path) {
  const YamlFile file(path);
  const cv::Size size = readSize(file);
  const ImagePlaneParams plane = readPlane(file);
  YamlCamera camera;
  try {
    if (const auto xi = file.number({"xi"}))
      camera.rig = makeRig(std::make_shared<UnifiedSphere>(size, *xi, plane));
    else
      camera.rig = makeRig(std::make_shared<Pinhole>(size, plane));
  } catch (const base::Error& e) {
    file.fail(e.what());
  }
  if (const auto mount = readMount(file)) {
    camera.rig.T_robot_cam = *mount;
    camera.onRobot = true;
  }
  readRectification(file, camera);
  return camera;
}

}  // namespace engram::cameras

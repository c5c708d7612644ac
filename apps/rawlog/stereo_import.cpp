// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_import.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"
#include "engram/cameras/pinhole.h"

#include <opencv2/core.hpp>

#include <cmath>
#include <sstream>
#include <vector>

namespace engram::apps {
namespace {

bool isYaml(const std::string& name) { return name.ends_with(".yaml") || name.ends_with(".yml"); }

std::vector<double> numbers(const cv::FileNode& node, std::size_t wanted, const std::string& origin) {
  std::vector<double> values;
  if (node.isSeq()) node >> values;
  if (values.size() != wanted)
    throw base::Error(origin + ": expected " + std::to_string(wanted) + " numbers, found " +
                      std::to_string(values.size()));
  return values;
}

std::string word(const cv::FileNode& node) { return node.isString() ? static_cast<std::string>(node) : ""; }

/// sensor.yaml of EuRoC's ASL format: T_BS, resolution, intrinsics, distortion.
cameras::CameraRig readEuroc(const std::string& path) {
  std::string text = base::readTextFile(path);
  if (!text.starts_with("%YAML")) text = "%YAML:1.0\n---\n" + text;
  cv::FileStorage file;
  try {
    file.open(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  } catch (const cv::Exception& e) {
    throw base::Error(path + ": is not YAML that can be read (" + e.err + ")");
  }
  const std::string camera = word(file["camera_model"]), distortion = word(file["distortion_model"]);
  if (camera != "pinhole" || distortion != "radial-tangential")
    throw base::Error(path + ": camera_model " + base::quoted(camera) + " with distortion_model " +
                      base::quoted(distortion) + "; only pinhole with radial-tangential can be used");
  const auto size = numbers(file["resolution"], 2, path + ": resolution");
  const auto k = numbers(file["intrinsics"], 4, path + ": intrinsics");
  const auto d = numbers(file["distortion_coefficients"], 4, path + ": distortion_coefficients");
  const auto t = numbers(file["T_BS"]["data"], 16, path + ": T_BS data");
  cameras::ImagePlaneParams plane{.fx = k[0], .fy = k[1], .cx = k[2], .cy = k[3]};
  plane.k1 = d[0], plane.k2 = d[1], plane.p1 = d[2], plane.p2 = d[3];
  auto rig = cameras::makeRig(std::make_shared<cameras::Pinhole>(
      cv::Size(static_cast<int>(size[0]), static_cast<int>(size[1])), plane));
  Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(t.data());
  if (!(T.topLeftCorner<3, 3>() * T.topLeftCorner<3, 3>().transpose()).isIdentity(1e-3))
    throw base::Error(path + ": T_BS is not a pose");
  rig.T_robot_cam.matrix() = T;
  rig.T_robot_cam.linear() = Eigen::Quaterniond(T.topLeftCorner<3, 3>()).normalized().toRotationMatrix();
  return rig;
}

/// Rows of a file that hold twelve numbers, with or without a name before them.
std::vector<Eigen::Matrix<double, 3, 4>> projections(const std::string& text) {
  std::vector<Eigen::Matrix<double, 3, 4>> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const auto colon = line.find(':'); colon != std::string::npos) line.erase(0, colon + 1);
    std::istringstream in(line);
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> P;
    int n = 0;
    while (n < 12 && in >> P.data()[n]) ++n;
    if (n == 12) found.emplace_back(P);
  }
  return found;
}

cameras::StereoRig readKitti(const std::string& path, cv::Size imageSize) {
  const auto found = projections(base::readTextFile(path));
  if (found.size() < 2) throw base::Error(path + ": holds no two projections of 3 x 4 numbers");
  const auto rig = [&](const Eigen::Matrix<double, 3, 4>& P) {
    const cameras::ImagePlaneParams plane{.fx = P(0, 0), .fy = P(1, 1), .cx = P(0, 2), .cy = P(1, 2)};
    if (!(plane.fx > 0) || !(plane.fy > 0)) throw base::Error(path + ": a focal length is not positive");
    auto out = cameras::makeRig(std::make_shared<cameras::Pinhole>(imageSize, plane));
    out.T_robot_cam.setIdentity();
    out.T_robot_cam.translation().x() = -P(0, 3) / P(0, 0);
    return out;
  };
  return {rig(found[0]), rig(found[1])};
}

}  // namespace

std::optional<cameras::StereoRig> importStereoRig(const std::string& files, cv::Size imageSize) {
  if (const auto comma = files.find(','); comma != std::string::npos) {
    const std::string left = files.substr(0, comma), right = files.substr(comma + 1);
    if (isYaml(left) && isYaml(right)) return cameras::StereoRig{readEuroc(left), readEuroc(right)};
  }
  if (files.ends_with(".txt")) return readKitti(files, imageSize);
  return std::nullopt;
}

}  // namespace engram::apps

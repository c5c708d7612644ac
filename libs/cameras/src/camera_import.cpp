// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/camera_import.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/cameras/pinhole.h"
#include "rig_text.h"
#include "yaml_camera.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

namespace engram::cameras {
namespace {

namespace fs = std::filesystem;

/// "a,b" as two paths, "calib.txt:P2" as a path and a name.
struct Files {
  std::string first, second, name;

  explicit Files(const std::string& text) : first(text) {
    if (const auto comma = text.find(','); comma != std::string::npos) {
      first = text.substr(0, comma);
      second = text.substr(comma + 1);
      if (second.find('/') == std::string::npos) second = (fs::path(first).parent_path() / second).string();
    }
    if (const auto colon = first.rfind(".txt:"); colon != std::string::npos) {
      name = first.substr(colon + 5);
      first.resize(colon + 4);
    }
  }
  bool kitti() const { return first.ends_with(".txt"); }
};

bool isYaml(const std::string& path) {
  return path.ends_with(".yaml") || path.ends_with(".yml") || path.ends_with(".xml");
}

using Projection = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

/// The rows of twelve numbers, by the name before their colon, or numbered as P0, P1, … where they have none.
std::map<std::string, Projection> projections(const std::string& path) {
  std::map<std::string, Projection> found;
  std::istringstream lines(readCalibrationFile(path));
  for (std::string line; std::getline(lines, line);) {
    std::string name = "P" + std::to_string(found.size());
    if (const auto colon = line.find(':'); colon != std::string::npos) {
      name = line.substr(0, colon);
      line.erase(0, colon + 1);
    }
    std::istringstream in(line);
    Projection P;
    int n = 0;
    while (n < 12 && in >> P.data()[n]) ++n;
    if (n == 12 && name.starts_with("P")) found.emplace(name, P);
  }
  return found;
}

CameraRig kittiRig(const std::string& path, const Projection& P, cv::Size imageSize) {
  const ImagePlaneParams plane{.fx = P(0, 0), .fy = P(1, 1), .cx = P(0, 2), .cy = P(1, 2)};
  if (!(plane.fx > 0) || !(plane.fy > 0)) throw base::ConfigError(path + ": a focal length is not positive");
  if (imageSize.empty())
    throw base::ConfigError(path +
                            ": KITTI's calibration does not tell the size of the images, which is not "
                            "known here; write it as a calibration of Engram");
  return makeRig(std::make_shared<Pinhole>(imageSize, plane));
}

/// The chosen camera and, where there is one, the next of the file.
std::pair<Projection, std::optional<Projection>> chooseKitti(const Files& files) {
  const auto found = projections(files.first);
  if (found.empty()) throw base::ConfigError(files.first + ": holds no projection of 3 x 4 numbers (P0: …)");
  const auto at = files.name.empty() ? found.begin() : found.find(files.name);
  if (at == found.end()) {
    std::string names;
    for (const auto& [name, P] : found) names += (names.empty() ? "" : ", ") + name;
    throw base::ConfigError(files.first + ": has no projection " + base::quoted(files.name) + ", but " +
                            names);
  }
  const auto next = std::next(at);
  return {at->second, next == found.end() ? std::nullopt : std::optional(next->second)};
}

std::optional<StereoRig> kittiStereo(const Files& files, cv::Size imageSize) {
  const auto [left, right] = chooseKitti(files);
  if (!right) return std::nullopt;
  StereoRig rig{kittiRig(files.first, left, imageSize), kittiRig(files.first, *right, imageSize)};
  const auto place = [](const Projection& P) { return -P(0, 3) / P(0, 0); };
  rig.left.T_robot_cam.setIdentity();
  rig.right.T_robot_cam.setIdentity();
  rig.left.T_robot_cam.translation().x() = place(left);
  rig.right.T_robot_cam.translation().x() = place(*right);
  return rig;
}

StereoRig yamlStereo(const Files& files) {
  YamlCamera left = readYamlCamera(files.first), right = readYamlCamera(files.second);
  if (!left.onRobot || !right.onRobot) {
    if (!left.baseline || !right.baseline || !(*right.baseline - *left.baseline > 0))
      throw base::ConfigError(files.second +
                              ": does not tell where the right camera is, seen from the left one: "
                              "it needs rectification_matrix and projection_matrix, or T_BS");
    Eigen::Isometry3d T_left_right = Eigen::Isometry3d::Identity();
    T_left_right.linear() = left.R_rectified_cam.transpose() * right.R_rectified_cam;
    T_left_right.translation() =
        left.R_rectified_cam.transpose() * Eigen::Vector3d(*right.baseline - *left.baseline, 0, 0);
    right.rig.T_robot_cam = left.rig.T_robot_cam * T_left_right;
  }
  return {std::move(left.rig), std::move(right.rig)};
}

}  // namespace

bool isForeignCalibration(const std::string& files) {
  const Files parts(files);
  return parts.kitti() || isYaml(parts.first);
}

CameraRig importCamera(const std::string& files, cv::Size imageSize) {
  const Files parts(files);
  if (parts.kitti()) return kittiRig(parts.first, chooseKitti(parts).first, imageSize);
  return readYamlCamera(parts.first).rig;
}

std::optional<StereoRig> importStereoRig(const std::string& files, cv::Size imageSize) {
  const Files parts(files);
  if (parts.kitti()) return kittiStereo(parts, imageSize);
  return parts.second.empty() ? std::nullopt : std::optional(yamlStereo(parts));
}

}  // namespace engram::cameras

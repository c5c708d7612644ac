// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera_rig.h"

#include <Eigen/Geometry>

#include <optional>
#include <string>

namespace engram::cameras {

/// One camera of a YAML file that ROS, OpenCV or EuRoC wrote.
struct YamlCamera {
  CameraRig rig;
  bool onRobot = false;  ///< the file tells where the camera is on the robot
  /// ROS: turns the camera into the rectified pair (rows of `R`), and where the rectified right eye stands
  /// [m].
  Eigen::Matrix3d R_rectified_cam = Eigen::Matrix3d::Identity();
  std::optional<double> baseline;
};

/// Throws base::ConfigError that names file and key.
YamlCamera readYamlCamera(const std::string& path);

}  // namespace engram::cameras

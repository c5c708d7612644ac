// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include <optional>

namespace engram::apps {

/// Where the robot is in the map at every image: where it was last found, carried on by odometry.
class PoseTracker {
 public:
  /// To be called for each image.
  /// @param fix T_map_robot when this image was found in the map
  /// @param T_odom_robot of this image
  void update(const std::optional<Eigen::Isometry3d>& fix,
              const std::optional<Eigen::Isometry3d>& T_odom_robot);

  /// None before the first fix, and where odometry is missing since the last one.
  const std::optional<Eigen::Isometry3d>& T_map_robot() const { return T_map_robot_; }

 private:
  std::optional<Eigen::Isometry3d> T_map_robot_, T_odom_last_;
};

}  // namespace engram::apps

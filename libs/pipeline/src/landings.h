// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <vector>

namespace engram::pipeline {

/// Poses that single images measured and that odometry cannot vouch for. An image may measure several, at one
/// place each; none of them is a witness for another.
class Landings {
 public:
  /// Whether an earlier image, the last that measured a pose, put the robot at the same one, but for the way
  /// between them.
  /// @param image its number. @param T_map_robot where this one puts the robot. @param T_own_robot by
  /// odometry
  /// @param within [m] of each other
  bool agree(std::uint64_t image, const Eigen::Isometry3d& T_map_robot, const Eigen::Isometry3d& T_own_robot,
             double within);
  void clear() { *this = {}; }

 private:
  struct Landing {
    Eigen::Isometry3d T_map_robot, T_own_robot;
  };
  std::optional<std::uint64_t> image_;
  std::vector<Landing> now_, before_;  // by this image, and by the last one before it that measured any
};

}  // namespace engram::pipeline

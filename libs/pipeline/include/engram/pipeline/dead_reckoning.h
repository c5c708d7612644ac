// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/types/rel_pose.h"

#include <optional>

namespace engram::pipeline {

/// Move: relative motion by odometry, with covariance. It integrates from an anchor, the place where the robot was
/// last certain to be.
class DeadReckoning {
 public:
  explicit DeadReckoning(const OdometryParams& params) : params_(params) {}

  /// Takes the odometry of a new image. @return false where there is none: the motion is unknown then.
  bool move(const std::optional<Eigen::Isometry3d>& T_odom_robot);

  /// The robot is at T_anchor_robot from the anchor, with this covariance.
  void reset(const Eigen::Isometry3d& T_anchor_robot, const types::Matrix6d& cov);

  bool known() const { return known_; }
  const types::RelPose& anchorToRobot() const { return T_anchor_robot_; }

  /// Distance [m] and rotation [rad] since markKeyframe().
  double distance() const { return distance_; }
  double rotation() const { return rotation_; }
  void markKeyframe() { distance_ = rotation_ = 0.0; }

 private:
  OdometryParams params_;
  std::optional<Eigen::Isometry3d> T_odom_last_;
  types::RelPose T_anchor_robot_;
  double distance_ = 0.0, rotation_ = 0.0;
  bool known_ = false;
};

/// T_a_b * T_b_c with the covariance of the product; the factors are independent (K-12 with K-E3).
types::RelPose compose(const types::RelPose& ab, const types::RelPose& bc);
/// T_b_a with its covariance.
types::RelPose inverse(const types::RelPose& ab);
/// Diagonal covariance; variances in x, y [m²] and yaw [rad²]; height, roll and pitch are held by `floor`.
types::Matrix6d planarCovariance(double sigmaX, double sigmaY, double sigmaYaw, double floor);

}  // namespace engram::pipeline

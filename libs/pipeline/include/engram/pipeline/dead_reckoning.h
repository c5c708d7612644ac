// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/types/rel_pose.h"

#include <optional>

namespace engram::pipeline {

/// What the wheels counted from one keyframe to the next.
struct Travel {
  double distance = 0.0;                           ///< along the way [m]
  Eigen::Vector2d step = Eigen::Vector2d::Zero();  ///< from keyframe to keyframe, in the odometry frame [m]
  double heading = 0.0;                            ///< of the robot now, in that frame [rad]
};

/// Move: relative motion by odometry, with covariance. It integrates from an anchor, the place where the
/// robot was last certain to be.
class DeadReckoning {
 public:
  explicit DeadReckoning(const OdometryParams& params) : params_(params) {}

  /// Takes the odometry of a new image, if it has any. The wheels count on while odometry is missing: the
  /// step over such a gap is what they counted.
  void move(const std::optional<Eigen::Isometry3d>& T_odom_robot);
  /// Takes odometry that no motion led to: the wheels count from there, and the way up to it is unknown.
  void leap(const Eigen::Isometry3d& T_odom_robot);

  /// The robot is now at T_anchor_robot from the anchor, with this covariance.
  void reset(const Eigen::Isometry3d& T_anchor_robot, const types::Matrix6d& cov);
  /// Something speaks against where the robot is: twice the deviations.
  void doubt() { T_anchor_robot_.cov *= 4; }
  /// Whether there is odometry now and was at reset(): anchorToRobot() is the whole motion then.
  bool anchored() const { return present_ && presentAtAnchor_; }
  const types::RelPose& anchorToRobot() const { return T_anchor_robot_; }

  void markKeyframe();
  /// Whether there is odometry now and was at markKeyframe().
  bool known() const { return present_ && presentAtKeyframe_; }
  /// The motion since markKeyframe(), when it is known.
  std::optional<Travel> travel() const;
  /// Distance [m] and rotation [rad] since markKeyframe().
  double distance() const { return distance_; }
  double rotation() const { return rotation_; }

 private:
  OdometryParams params_;
  std::optional<Eigen::Isometry3d> T_odom_last_, T_odom_keyframe_;
  types::RelPose T_anchor_robot_;
  double distance_ = 0.0, rotation_ = 0.0;
  bool present_ = false, presentAtAnchor_ = false, presentAtKeyframe_ = false;  // odometry
};

/// Diagonal covariance; variances in x, y [m²] and yaw [rad²]; height, roll and pitch are held by `floor`.
types::Matrix6d planarCovariance(double sigmaX, double sigmaY, double sigmaYaw, double floor);

}  // namespace engram::pipeline

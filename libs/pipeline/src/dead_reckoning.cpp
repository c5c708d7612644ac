// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/dead_reckoning.h"

#include "engram/types/se3.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
types::Matrix6d planarCovariance(double sigmaX, double sigmaY, double sigmaYaw, double floor) {
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << sigmaX, sigmaY, floor, floor, floor, sigmaYaw;
  return sigma.cwiseMax(floor).cwiseAbs2().asDiagonal();
}

void DeadReckoning::move(const std::optional<Eigen::Isometry3d>& T_odom_robot) {
  present_ = T_odom_robot.has_value();
  if (!present_) return;
  if (T_odom_last_) {
    types::RelPose step;
    step.T_a_b = T_odom_last_->inverse() * *T_odom_robot;
    const double d = step.T_a_b.translation().norm();
    const double angle = std::abs(Eigen::AngleAxisd(step.T_a_b.linear()).angle());
    // Independent steps: variances add with the distance, so a step's deviation goes with its square root.
    const double sigma = params_.sigma_per_metre * std::sqrt(d);
    const double sigmaYaw = std::hypot(params_.sigma_heading_per_metre * std::sqrt(d),
                                       params_.sigma_heading_per_radian * std::sqrt(angle));
    step.cov = planarCovariance(sigma, sigma, sigmaYaw, 1e-6);
    T_anchor_robot_ = types::compose(T_anchor_robot_, step);
    distance_ += d;
    rotation_ += angle;
  }
  T_odom_last_ = T_odom_robot;
}

void DeadReckoning::leap(const Eigen::Isometry3d& T_odom_robot) {
  T_odom_last_ = T_odom_robot;
  present_ = true;
  presentAtAnchor_ = presentAtKeyframe_ = false;
}

void DeadReckoning::reset(const Eigen::Isometry3d& T_anchor_robot, const types::Matrix6d& cov) {
  T_anchor_robot_.T_a_b = T_anchor_robot;
  T_anchor_robot_.cov = cov;
  presentAtAnchor_ = present_;
}

std::optional<Travel> DeadReckoning::travel() const {
  if (!known()) return std::nullopt;
  const Eigen::Isometry3d& T = *T_odom_last_;
  const Eigen::Vector3d step = T.translation() - T_odom_keyframe_->translation();
  return Travel{distance_, step.head<2>(), std::atan2(T(1, 0), T(0, 0))};
}

void DeadReckoning::markKeyframe() {
  distance_ = rotation_ = 0.0;
  T_odom_keyframe_ = T_odom_last_;
  presentAtKeyframe_ = present_;
}

}  // namespace engram::pipeline

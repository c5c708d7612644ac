// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/dead_reckoning.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
namespace {

/// Adjoint of T for perturbations d = (translation, rotation) on the right: T exp(d) T^-1 = exp(Ad d).
types::Matrix6d adjoint(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d t = T.translation();
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  types::Matrix6d A = types::Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = R;
  A.topRightCorner<3, 3>() = cross * R;
  A.bottomRightCorner<3, 3>() = R;
  return A;
}

}  // namespace

types::Matrix6d planarCovariance(double sigmaX, double sigmaY, double sigmaYaw, double floor) {
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << sigmaX, sigmaY, floor, floor, floor, sigmaYaw;
  return sigma.cwiseMax(floor).cwiseAbs2().asDiagonal();
}

types::RelPose compose(const types::RelPose& ab, const types::RelPose& bc) {
  types::RelPose ac;
  ac.T_a_b = ab.T_a_b * bc.T_a_b;
  const types::Matrix6d A = adjoint(bc.T_a_b.inverse());
  ac.cov = A * ab.cov * A.transpose() + bc.cov;
  ac.cov = 0.5 * (ac.cov + ac.cov.transpose().eval());
  ac.hasScale = ab.hasScale && bc.hasScale;
  return ac;
}

types::RelPose inverse(const types::RelPose& ab) {
  types::RelPose ba = ab;
  ba.T_a_b = ab.T_a_b.inverse();
  const types::Matrix6d A = adjoint(ab.T_a_b);
  ba.cov = A * ab.cov * A.transpose();
  ba.cov = 0.5 * (ba.cov + ba.cov.transpose().eval());
  return ba;
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
    T_anchor_robot_ = compose(T_anchor_robot_, step);
    distance_ += d;
    rotation_ += angle;
  }
  T_odom_last_ = T_odom_robot;
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

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/types/pose2.h"

#include <cmath>

namespace engram::types {
namespace {

/// The matrix V of exp(theta, v) = (theta, V v) in SE(2): Solà et al. 2018, "A micro Lie theory", eq (158).
Eigen::Matrix2d leftJacobian(double theta) {
  double a = 1.0 - theta * theta / 6.0;  // sin(t) / t
  double b = theta / 2.0;                // (1 - cos(t)) / t
  if (std::abs(theta) > 1e-4) {
    a = std::sin(theta) / theta;
    b = (1.0 - std::cos(theta)) / theta;
  }
  return (Eigen::Matrix2d() << a, -b, b, a).finished();
}

}  // namespace

Pose2 compose(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.heading), s = std::sin(a.heading);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y,
          std::remainder(a.heading + b.heading, 2.0 * M_PI)};
}

Pose2 between(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.heading), s = std::sin(a.heading);
  const double dx = b.x - a.x, dy = b.y - a.y;
  return {c * dx + s * dy, -s * dx + c * dy, std::remainder(b.heading - a.heading, 2.0 * M_PI)};
}

Pose2 interpolate(const Pose2& a, const Pose2& b, double s) {
  const Pose2 step = between(a, b);
  const Eigen::Vector2d velocity = leftJacobian(step.heading).inverse() * Eigen::Vector2d(step.x, step.y);
  const Eigen::Vector2d part = leftJacobian(s * step.heading) * (s * velocity);
  return compose(a, {part.x(), part.y(), s * step.heading});
}

Eigen::Isometry3d toIsometry(const Pose2& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(pose.x, pose.y, 0.0);
  T.linear() = Eigen::AngleAxisd(pose.heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

Pose2 toPose2(const Eigen::Isometry3d& pose) {
  return {pose.translation().x(), pose.translation().y(),
          std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))};
}

}  // namespace engram::types

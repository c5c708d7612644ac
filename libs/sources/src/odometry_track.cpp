// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/odometry_track.h"

#include <algorithm>
#include <cmath>

namespace engram::sources {
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
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y, std::remainder(a.yaw + b.yaw, 2.0 * M_PI)};
}

Pose2 between(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  const double dx = b.x - a.x, dy = b.y - a.y;
  return {c * dx + s * dy, -s * dx + c * dy, std::remainder(b.yaw - a.yaw, 2.0 * M_PI)};
}

Pose2 interpolate(const Pose2& a, const Pose2& b, double s) {
  const Pose2 step = between(a, b);
  const Eigen::Vector2d velocity = leftJacobian(step.yaw).inverse() * Eigen::Vector2d(step.x, step.y);
  const Eigen::Vector2d part = leftJacobian(s * step.yaw) * (s * velocity);
  return compose(a, {part.x(), part.y(), s * step.yaw});
}

Eigen::Isometry3d toIsometry(const Pose2& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(pose.x, pose.y, 0.0);
  T.linear() = Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

Pose2 toPose2(const Eigen::Isometry3d& pose) {
  return {pose.translation().x(), pose.translation().y(),
          std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))};
}

void OdometryTrack::add(double stamp, const Pose2& pose) {
  samples_.push_back({stamp, pose});
  if (samples_.size() > kMaxSamples) samples_.pop_front();
}

std::optional<Pose2> OdometryTrack::at(double stamp, double hold) const {
  if (samples_.empty()) return std::nullopt;
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp,
                                      [](const Sample& sample, double t) { return sample.stamp < t; });
  if (after == samples_.end())
    return stamp - samples_.back().stamp <= hold ? std::optional(samples_.back().pose) : std::nullopt;
  if (after->stamp == stamp) return after->pose;
  if (after == samples_.begin())
    return after->stamp - stamp <= hold ? std::optional(after->pose) : std::nullopt;
  const auto before = std::prev(after);
  return interpolate(before->pose, after->pose, (stamp - before->stamp) / (after->stamp - before->stamp));
}

}  // namespace engram::sources

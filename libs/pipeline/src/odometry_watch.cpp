// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/odometry_watch.h"

#include "engram/base/text.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

namespace engram::pipeline {
namespace {

constexpr double kLeastSeconds = 0.02;  // between images; stamps that are nearer are not believed
constexpr double kSlack = 0.5;          // [m] that a step may differ from what was expected: geometry sees it
constexpr double kClearWay = 0.3;       // [m] from which a way has a direction worth comparing

// A fault of units or axes is told from so many ways, and from so much turning [rad]; these are the bounds of
// what passes for sound. A wheel base that is wrong by a tenth shows in the ratio, a mirrored axis in its
// sign.
constexpr int kEnough = 5;
constexpr double kTurnedEnough = 1.5;
constexpr double kLeastRatio = 0.7, kMostRatio = 1.4, kMostResidual = 0.5, kLeastCosine = 0.5;

double yawOf(const Eigen::Matrix3d& R) { return std::atan2(R(1, 0), R(0, 0)); }

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string ofHeading(const OdometryHealth& h) {
  const std::string images = "where the images turned by " + fixed(h.turned, 1) + " rad";
  if (h.headingResidual > kMostResidual)
    return "the heading of the odometry does not follow the images: " + images + ", " +
           fixed(100 * h.headingResidual, 0) + " % is not explained by it; is it in radians?";
  const std::string measured = images + ", it turned " + fixed(h.headingRatio, 2) + " times as far";
  return h.headingRatio < 0 ? "the odometry turns the other way: " + measured + "; to the left it must grow"
                            : "the odometry turns wrongly: " + measured + "; is the wheel base right?";
}

}  // namespace

bool OdometryWatch::leaps(const Eigen::Isometry3d& T_odom_robot, double stamp) {
  const auto last = std::exchange(last_, Reading{T_odom_robot, stamp});
  if (!last) return false;
  ++health_.steps;
  const double seconds = std::max(kLeastSeconds, stamp - last->stamp);
  const Eigen::Isometry3d step = last->T_odom_robot.inverse() * T_odom_robot;
  const double speed = step.translation().norm() / seconds;
  const double turned = std::abs(Eigen::AngleAxisd(step.linear()).angle());
  const auto before = std::exchange(velocity_, std::nullopt);
  const bool jerks = before && (step.translation() - seconds * *before).norm() >
                                   kSlack + params_.max_acceleration * seconds * seconds;
  if (jerks || speed > params_.max_speed || turned > params_.max_turn_rate * seconds) {
    ++health_.leaps;
    health_.fastestLeap = std::max(health_.fastestLeap, speed);
    return true;
  }
  velocity_ = step.translation() / seconds;
  health_.fastest = std::max(health_.fastest, speed);
  return false;
}

void OdometryWatch::compare(const Eigen::Isometry3d& way, const Eigen::Matrix3d& R_sight,
                            const Eigen::Vector3d& direction) {
  const double sight = yawOf(R_sight), wheels = yawOf(way.linear());
  ++health_.compared;
  health_.turned += std::abs(sight);
  sightSquared_ += sight * sight;
  wheelsSquared_ += wheels * wheels;
  product_ += sight * wheels;
  if (sightSquared_ > 0) health_.headingRatio = product_ / sightSquared_;
  // Least squares: the part of the wheels' turning that no ratio of the images' explains.
  if (sightSquared_ > 0 && wheelsSquared_ > 0)
    health_.headingResidual =
        std::sqrt(std::max(0.0, 1 - product_ * product_ / (sightSquared_ * wheelsSquared_)));
  if (direction.isZero() || way.translation().norm() < kClearWay) return;
  cosines_ += way.translation().normalized().dot(direction);
  health_.directionCosine = cosines_ / ++health_.directions;
}

OdometryFault faultOf(const OdometryHealth& h) {
  if (h.steps >= kEnough && 2 * h.leaps > h.steps) return OdometryFault::kTooFast;
  if (h.frozen >= kEnough) return OdometryFault::kFrozen;
  const bool turns = h.compared >= kEnough && h.turned >= kTurnedEnough;
  const bool ratioFits = h.headingRatio >= kLeastRatio && h.headingRatio <= kMostRatio;
  if (turns && (!ratioFits || h.headingResidual > kMostResidual)) return OdometryFault::kHeading;
  if (h.directions >= kEnough && h.directionCosine < kLeastCosine) return OdometryFault::kDirection;
  return h.leaps > 0 ? OdometryFault::kLeaps : OdometryFault::kNone;
}

bool isGrave(const OdometryHealth& h) {
  const OdometryFault fault = faultOf(h);
  return fault != OdometryFault::kNone && fault != OdometryFault::kLeaps;
}

std::string describe(const OdometryHealth& h) {
  const std::string speed = "up to " + fixed(h.fastestLeap, 1) + " m/s";
  switch (faultOf(h)) {
    case OdometryFault::kNone:
      return {};
    case OdometryFault::kLeaps:
      return "the odometry leapt " + base::counted(static_cast<std::size_t>(h.leaps), "time") + " (" + speed +
             "); the way there was taken for unknown";
    case OdometryFault::kTooFast:
      return "the odometry was left out: " + std::to_string(h.leaps) + " of " + std::to_string(h.steps) +
             " steps are faster than the robot can be (" + speed +
             "); is it in metres? else set [odometry] max_speed";
    case OdometryFault::kFrozen:
      return "the odometry stood still at " + std::to_string(h.frozen) +
             " images that show the robot moving; is an encoder dead?";
    case OdometryFault::kHeading:
      return ofHeading(h);
    case OdometryFault::kDirection:
      return "the odometry moves to other sides than the images show (mean cosine " +
             fixed(h.directionCosine, 2) + "); x must point forward, y to the left";
  }
  return {};
}

}  // namespace engram::pipeline

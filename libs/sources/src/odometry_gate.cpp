// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/odometry_gate.h"

#include <cmath>

namespace engram::sources {
namespace {

constexpr double kFarthest = 2e7;     // [m] half the way round the Earth; coordinates of UTM are below 1e7
constexpr double kMostTurned = 1e6;   // [rad] of a heading that is counted on: 160,000 turns
constexpr double kLongestStep = 1e4;  // [m]

PoseVerdict judge(const Pose2& pose, double farthest) {
  if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.heading))
    return PoseVerdict::kNotFinite;
  const bool wild =
      std::abs(pose.x) > farthest || std::abs(pose.y) > farthest || std::abs(pose.heading) > kMostTurned;
  return wild ? PoseVerdict::kWild : PoseVerdict::kPass;
}

}  // namespace

PoseVerdict judgePose(const Pose2& pose) { return judge(pose, kFarthest); }
PoseVerdict judgeStep(const Pose2& step) { return judge(step, kLongestStep); }

}  // namespace engram::sources

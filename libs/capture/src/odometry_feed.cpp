// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_feed.h"

#include "engram/sources/odometry_gate.h"

#include <cmath>

namespace engram::capture {

void OdometryFeed::add(double stamp, const sources::Pose2& pose) {
  const std::lock_guard lock(mutex_);
  if (std::isnan(stamp) || sources::judgePose(pose) != sources::PoseVerdict::kPass) return void(++leftOut_);
  switch (gate_.check(stamp)) {
    case sources::StampGate::Verdict::kPass:
      break;
    case sources::StampGate::Verdict::kRestart:
      track_.clear();
      break;
    default:
      return;
  }
  track_.add(stamp, pose);
  ++readings_;
  added_.notify_all();
}

std::optional<sources::Pose2> OdometryFeed::at(double stamp, double hold,
                                               std::chrono::duration<double> patience) const {
  std::unique_lock lock(mutex_);
  added_.wait_for(lock, patience, [&] { return track_.covers(stamp); });
  return track_.at(stamp, hold);
}

std::size_t OdometryFeed::leftOut() const {
  const std::lock_guard lock(mutex_);
  return leftOut_;
}

std::size_t OdometryFeed::readings() const {
  const std::lock_guard lock(mutex_);
  return readings_;
}

}  // namespace engram::capture

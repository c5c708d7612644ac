// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/odometry_track.h"
#include "engram/sources/stamp_gate.h"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>

namespace engram::capture {

/// Odometry from the thread of its sensor, for images that are younger than the last reading.
class OdometryFeed {
 public:
  /// Readings that are not numbers or that no robot can have (sources::judgePose), and those whose stamps do
  /// not rise, are left out. @param stamp [s]
  void add(double stamp, const sources::Pose2& pose);

  /// The pose at `stamp`: as soon as a reading is that late, or after `patience` from what there is.
  /// @param hold time that the last reading stands for later images [s]
  std::optional<sources::Pose2> at(double stamp, double hold, std::chrono::duration<double> patience) const;

  std::size_t readings() const;
  /// For what they say, not for their stamps.
  std::size_t leftOut() const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable added_;
  sources::OdometryTrack track_;
  sources::StampGate gate_;
  std::size_t readings_ = 0, leftOut_ = 0;
};

}  // namespace engram::capture

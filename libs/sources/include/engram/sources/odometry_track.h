// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/pose2.h"

#include <deque>
#include <optional>

namespace engram::sources {

using types::Pose2;

/// The last samples of wheel odometry, to be asked for the pose at the stamp of an image.
class OdometryTrack {
 public:
  /// Stamps [s] must rise.
  void add(double stamp, const Pose2& pose);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }

  /// True when no later sample can change the answer of at(stamp).
  bool covers(double stamp) const { return !samples_.empty() && samples_.back().stamp >= stamp; }

  /// The pose at `stamp`: interpolated between its neighbours; before the first and after the last sample
  /// that sample is held for `hold` seconds, and then there is none.
  std::optional<Pose2> at(double stamp, double hold) const;

 private:
  struct Sample {
    double stamp;
    Pose2 pose;
  };
  static constexpr std::size_t kMaxSamples =
      4096;  // constant memory; 40 s at 100 Hz is far more than images lag
  std::deque<Sample> samples_;
};

}  // namespace engram::sources

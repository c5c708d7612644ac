// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/odometry_track.h"

#include <algorithm>

namespace engram::sources {

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

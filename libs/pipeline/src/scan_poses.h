// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "steps.h"

#include <memory>

namespace engram::pipeline {

/// Where the robot, the scan before and the reference scans are, by either back-end: V's filter over all of
/// them, or the graph of the map (V-12). `PlaceId()` names the scan before. The robot of the run follows.
class ScanPoses {
 public:
  virtual ~ScanPoses() = default;

  /// The first scan of an empty map is taken here.
  virtual void start(Run& run) = 0;
  /// Nobody knows where the robot is.
  virtual void lose() = 0;
  /// The robot is where a reference shows it, whatever was believed before.
  virtual void relocate(Run& run, const Link& link) = 0;
  /// Whether there is any belief of where the robot is, be it ever so vague.
  virtual bool begun(const Run& run) const = 0;

  /// One step on (V eq 7): where the robot was is where the scan before was taken.
  virtual void step(Run& run, const types::RelPose& T_last_now) = 0;
  /// Where the robot should be, seen from a reference or from the scan before.
  virtual types::RelPose expected(const Run& run, base::PlaceId from) const = 0;
  /// Takes a measurement unless it contradicts what is known (V-E5). @returns whether it was taken
  virtual bool measure(Run& run, const Link& link) = 0;

  virtual Eigen::Isometry3d T_map_previous(const Run& run) const = 0;
  /// The scan before has become this node of the map (V-08).
  virtual void promote(Run& run, base::PlaceId node) = 0;

  /// The poses of the map follow. @param made the node of this image; invalid without
  virtual void settle(Run& run, base::PlaceId made) = 0;
  /// The drive has ended.
  virtual void finish(Run& run) = 0;
};

/// By [posegraph] relaxer: `ekf_scans`, or a relaxer of graphs.
std::unique_ptr<ScanPoses> makeScanPoses(const Run& run);

}  // namespace engram::pipeline

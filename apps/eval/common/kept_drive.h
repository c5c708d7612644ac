// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/trajectory.h"
#include "engram/types/frame.h"
#include "engram/world/world.h"

#include <functional>
#include <string>
#include <vector>

namespace engram::apps {

/// A simulated drive on disk: a rawlog with odometry, as engram-slam takes it, and the truth beside it.
struct KeptDrive {
  std::string rawlog;            ///< `<stem>.rawlog`; the truth is in `<stem>.truth.tum`
  std::string weather;           ///< what the building looked like, in words
  double lap = 0;                ///< length of one round [m]
  evaluation::Trajectory truth;  ///< T_world_robot of every image
  std::vector<double> arcs;      ///< way along the route since the start, of every image [m]

  /// Calls `see` for every image, in order, as a robot would deliver it. Throws base::Error when the rawlog
  /// is damaged, base::Interrupted on Ctrl-C.
  void forEachFrame(const std::function<void(const types::Frame&)>& see) const;
  /// Number of images in the first round.
  std::size_t firstLapImages() const;
};

/// Renders a drive once; later runs read it again, if the same world and camera made it.
/// @param stem path without an ending
/// @param progress is called with the share done
KeptDrive keepDrive(const world::World& world, const world::Eyes& eyes, int session, const std::string& stem,
                    int threads, const std::function<void(double)>& progress);

}  // namespace engram::apps

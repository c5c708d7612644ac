// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/store/whole_map.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace engram::keeper {

// What a keeper of maps does to a map that nobody drives in. Each changes the value and says what it did.

/// What reduce() is to come to. Either bound may be missing.
struct Target {
  std::optional<std::size_t> views;    ///< places of the map: in a map of views each is one
  std::optional<std::uint64_t> bytes;  ///< of all rows, see store::rowBytes()
};

struct Reduced {
  std::size_t removed = 0;   ///< places
  double distance = 0;       ///< [m] nearer than this was one neighbourhood in the end
  int perNeighbourhood = 0;  ///< views that it kept
  std::uint64_t bytes = 0;   ///< of the rows that are left, records and path with them
  bool reached = false;
};

/// Upkeep offline: the rule of upkeep (K-28) with neighbourhoods that keep fewer views, down to one, and then
/// grow, until the map is as small as asked for. Redundant views go first, the oldest of the largest cluster;
/// the graph stays together. Path, drives and records stay.
Reduced reduce(store::WholeMap& map, const Target& target, const pipeline::PipelineParams& params);

/// Every place follows what the edges say, and every closure is examined again, as at the end of a drive.
struct Relaxed {
  double moved = 0, movedMost = 0;  ///< mean and largest distance that places moved [m]
  std::size_t dropped = 0;          ///< closures that the graph denies
};
/// Throws base::Error for a map of scans, whose poses a filter keeps.
Relaxed relax(store::WholeMap& map, const pipeline::PipelineParams& params);

struct DroppedDrive {
  std::size_t places = 0, views = 0, pathPoints = 0, records = 0;
  std::size_t kept = 0;  ///< places that it made and other drives have been at: they stay
};
/// Takes a drive out: its path, its views, its records, and the places that no other drive has been at. What
/// places of other drives learnt from it stays: a memory does not know whom it has a vote from.
/// Throws base::Error when there is no such drive, or no place would be left.
DroppedDrive dropDrive(store::WholeMap& map, std::uint32_t drive);

/// A rectangle of the map frame [m].
struct Region {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool contains(const Eigen::Vector3d& p) const {
    return p.x() >= x0 && p.x() <= x1 && p.y() >= y0 && p.y() <= y1;
  }
};

struct Cropped {
  std::size_t places = 0, pathPoints = 0, records = 0;  ///< that have gone
};
/// Keeps what is in a region; ways through the outside become edges between its ends.
/// Throws base::Error when no place is in it.
Cropped crop(store::WholeMap& map, const Region& region);

struct Anonymised {
  std::size_t pictures = 0, names = 0;  ///< thumbnails and names of files that have gone
  std::size_t features = 0;             ///< that one view saw and none again
};
/// Takes away what shows people, or names them: thumbnails, names of files, and short-term features that were
/// seen once, as those of passers-by are. The map locates as before: long-term features stay.
/// @param keepNames names of images and rawlogs stay
Anonymised anonymise(store::WholeMap& map, bool keepNames);

}  // namespace engram::keeper

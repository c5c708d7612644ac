// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"

#include <vector>

namespace engram::map {

/// Points of paths that lie in one part of the map.
struct JoinedPath {
  std::vector<PathPoint> points;  ///< of the part that most of them are in, in their order
  double apart = 0;               ///< share of the points in other parts
};

/// Where the parts of a map lie to each other is a guess of weak links: an error of a trajectory is one
/// within a part (K-E14). Of parts with equally many points the one that holds the earliest. `points` of
/// places that the map has no more are left out.
JoinedPath joinedPath(const TopologicalMap& map, const std::vector<PathPoint>& points);

}  // namespace engram::map

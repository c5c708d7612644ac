// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/types/rel_pose.h"

#include <vector>

namespace engram::upkeep {

using base::PlaceId;

/// What counts as near a view (K-26, K-27).
struct NeighbourhoodParams {
  double distance = 0.5;         ///< eta_d [m]
  double angle = 0.1745329252;   ///< eta_phi [rad]
  double search_distance = 2.0;  ///< the search goes through places at most so far from the view [m]
  double search_sigma = 1.0;     ///< and no farther than it knows where it is, standard deviation [m]
};

/// A place and where it is, seen from the view.
struct NearPlace {
  PlaceId place{};
  types::RelPose T_view_place{};
};

/// The places within `distance` and `angle` of a view, by rising id, without itself (K-26). Found along the
/// edges: from place to place on the most certain chain, with the poses of the edges, not those of the map.
/// Two places that a long way round has brought together in the map are not near, for nothing says how far
/// apart they are. Weak edges (K-E14) and edges without scale are not walked. The work depends on what is
/// around the view, not on the size of the map.
std::vector<NearPlace> neighbourhood(const map::TopologicalMap& map, PlaceId view,
                                     const NeighbourhoodParams& params);

}  // namespace engram::upkeep

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"

#include <span>
#include <vector>

namespace engram::upkeep {

using base::PlaceId;

/// How the graph is mended where a place is cut out.
struct Mending {
  PlaceId heir{};                    ///< the place that takes over its links; invalid when it has no edge
  std::vector<map::Edge> bridges{};  ///< from the heir to other former neighbours; without ids
};

/// The edges that keep a graph together when a place leaves it (K-13).
///
/// The heir is the cluster mate that the place is joined to best; where it has none, the neighbour that it is
/// joined to best. Each other neighbour without a link to the rest of the cluster, as far as that hangs
/// together with the heir, gets one to the heir, compounded from the two edges over the place (K-12). For a
/// cluster of one, K joins all pairs of neighbours: k (k - 1) / 2 edges that all repeat the same k
/// measurements. We take the tree that is the most certain of these, the star around the heir: at most k - 1
/// edges, so that a graph never grows by a deletion (K-E4). And since each bridge of the star uses the edge
/// of the heir, that edge is given to n bridges with n times its covariance: what is then known of the
/// remaining poses is at most what was known before. A single bridge is K eq (2) and (3), exactly.
///
/// Whatever was connected stays so, with weak edges and without. A bridge over a weak edge is weak; one over
/// an edge without scale knows the rotation alone.
/// @param mates other places of its cluster; those that are not in the map are passed over
/// @throws base::Error when there is no such place.
Mending mend(const map::TopologicalMap& map, PlaceId gone, std::span<const PlaceId> mates);

}  // namespace engram::upkeep

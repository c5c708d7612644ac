// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/posegraph/graph.h"

namespace engram::map {

/// An edge as the relaxers see it. Loop and recognition edges are robust.
posegraph::Constraint toConstraint(const Edge& edge);

/// The pose graph of the map, for the relaxers and for files: every place and every edge. Weak
/// edges take part with their large covariance, so that disjoint drives
/// stay connected (K-11).
posegraph::Graph toGraph(const TopologicalMap& map);

}  // namespace engram::map

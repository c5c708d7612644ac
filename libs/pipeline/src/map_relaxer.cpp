// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/map_relaxer.h"

#include "engram/map/graph.h"

namespace engram::pipeline {
namespace {

void apply(map::TopologicalMap& map, const posegraph::Relaxation& relaxed) {
  if (relaxed.ending == posegraph::Ending::kConverged || relaxed.ending == posegraph::Ending::kIterationLimit)
    map.setPoses(relaxed.poses);
}

}  // namespace

void MapRelaxer::around(map::TopologicalMap& map, base::PlaceId centre) const {
  const auto constraintsOf = [&](base::PlaceId id) {
    std::vector<posegraph::Constraint> constraints;
    for (const map::Neighbour& n : map.neighbours(id))
      constraints.push_back(map::toConstraint(map.edge(n.edge)));
    return constraints;
  };
  const auto poseOf = [&](base::PlaceId id) { return map.place(id).T_map_place; };
  apply(map, relaxer_->relax(posegraph::windowAround(centre, params_.window_hops, params_.window_places,
                                                     constraintsOf, poseOf)));
}

void MapRelaxer::all(map::TopologicalMap& map) const { apply(map, relaxer_->relax(map::toGraph(map))); }

}  // namespace engram::pipeline

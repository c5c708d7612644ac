// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/graph.h"

namespace engram::map {

posegraph::Constraint toConstraint(const Edge& edge) {
  const bool robust = edge.type == EdgeType::kLoop || edge.type == EdgeType::kRecognition;
  return {edge.a, edge.b, edge.T_a_b, robust};
}

posegraph::Graph toGraph(const TopologicalMap& map) {
  posegraph::Graph graph;
  for (const auto& [id, place] : map.places()) graph.poses[id] = place.T_map_place;
  for (const auto& [id, edge] : map.edges()) graph.constraints.push_back(toConstraint(edge));
  return graph;
}

}  // namespace engram::map

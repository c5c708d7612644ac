// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/window.h"

#include "engram/base/error.h"

#include <deque>

namespace engram::posegraph {

Adjacency::Adjacency(const Graph& graph) {
  for (std::size_t i = 0; i < graph.constraints.size(); ++i)
    add(i, graph.constraints[i].a, graph.constraints[i].b);
}

void Adjacency::add(std::size_t position, PlaceId a, PlaceId b) {
  positions_[a].push_back(position);
  positions_[b].push_back(position);
}

const std::vector<std::size_t>& Adjacency::at(PlaceId place) const {
  static const std::vector<std::size_t> kNone;
  const auto it = positions_.find(place);
  return it == positions_.end() ? kNone : it->second;
}

Window windowAround(PlaceId centre, int hops, int maxPlaces, const ConstraintsOf& constraintsOf,
                    const PoseOf& poseOf) {
  Window window;
  std::set<PlaceId> inside, queued{centre};
  std::deque<std::pair<PlaceId, int>> queue{{centre, 0}};
  while (!queue.empty() && static_cast<int>(inside.size()) < maxPlaces) {
    const auto [place, depth] = queue.front();
    queue.pop_front();
    for (Constraint& c : constraintsOf(place)) {
      const PlaceId other = c.a == place ? c.b : c.a;
      if (depth < hops && queued.insert(other).second) queue.emplace_back(other, depth + 1);
      if (!inside.contains(other)) window.graph.constraints.push_back(std::move(c));
    }
    inside.insert(place);
    window.graph.poses[place] = poseOf(place);
  }
  for (const Constraint& c : window.graph.constraints)
    for (const PlaceId id : {c.a, c.b})
      if (!inside.contains(id) && window.held.insert(id).second) window.graph.poses[id] = poseOf(id);
  return window;
}

Window windowAround(const Graph& graph, const Adjacency& adjacency, PlaceId centre, int hops, int maxPlaces) {
  const auto poseOf = [&](PlaceId id) {
    const auto it = graph.poses.find(id);
    if (it == graph.poses.end())
      throw base::Error("place " + std::to_string(id.value) + " has no pose; call addMissingPoses() first");
    return it->second;
  };
  const auto constraintsOf = [&](PlaceId id) {
    std::vector<Constraint> out;
    for (const std::size_t i : adjacency.at(id)) out.push_back(graph.constraints[i]);
    return out;
  };
  return windowAround(centre, hops, maxPlaces, constraintsOf, poseOf);
}

}  // namespace engram::posegraph

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/closure_book.h"

#include "engram/map/graph.h"

#include <algorithm>
#include <set>

namespace engram::pipeline {
namespace {

bool isClosure(map::EdgeType type) {
  return type == map::EdgeType::kLoop || type == map::EdgeType::kRecognition;
}

posegraph::ClosureDecision agreed() { return {true, posegraph::ClosureReason::kAgrees, 0, 0, 0}; }

std::map<base::PlaceId, int> partOf(const map::TopologicalMap& map, base::PlaceId place) {
  return map.hopDistances(place, static_cast<int>(map.places().size()));
}

}  // namespace

void ClosureBook::load(const map::TopologicalMap& map) {
  for (const auto& [id, edge] : map.edges())
    if (isClosure(edge.type)) enter(edge);
}

void ClosureBook::enter(const map::Edge& edge) {
  entries_.push_back({edge, agreed()});
  judged_ = entries_.size();
}

/// Odometry and what is derived from it. A weak edge is a guess: it must not deny anything.
posegraph::Graph ClosureBook::trusted(const map::TopologicalMap& map) const {
  posegraph::Graph graph;
  for (const auto& [id, place] : map.places()) graph.poses[id] = place.T_map_place;
  for (const auto& [id, edge] : map.edges())
    if (!isClosure(edge.type) && edge.type != map::EdgeType::kWeak)
      graph.constraints.push_back({edge.a, edge.b, edge.T_a_b, false});
  return graph;
}

posegraph::ClosureDecision ClosureBook::propose(const map::TopologicalMap& map, map::Edge edge) {
  poses_.clear();
  edge.id = {};
  const bool joins = !partOf(map, edge.a).contains(edge.b);
  if (joins) alignPart(map, edge);
  entries_.push_back({std::move(edge), agreed()});
  if (joins) judged_ = entries_.size();
  proposed_ = true;
  judge(map);
  return entries_.back().decision;
}

void ClosureBook::review(const map::TopologicalMap& map) {
  poses_.clear();
  proposed_ = false;
  judge(map);
}

/// Two parts of the map that knew nothing of each other: the one with the later first place moves to where
/// the closure puts it.
void ClosureBook::alignPart(const map::TopologicalMap& map, const map::Edge& edge) {
  const auto partA = partOf(map, edge.a), partB = partOf(map, edge.b);
  const bool moveA = partB.begin()->first < partA.begin()->first;
  const Eigen::Isometry3d T_map_a = map.place(edge.a).T_map_place, T_map_b = map.place(edge.b).T_map_place;
  const Eigen::Isometry3d T_new_old = moveA ? T_map_b * edge.T_a_b.T_a_b.inverse() * T_map_a.inverse()
                                            : T_map_a * edge.T_a_b.T_a_b * T_map_b.inverse();
  for (const auto& [id, hops] : moveA ? partA : partB) poses_[id] = T_new_old * map.place(id).T_map_place;
}

void ClosureBook::judge(const map::TopologicalMap& map) {
  posegraph::Graph graph = trusted(map);
  for (const auto& [id, T_map_place] : poses_) graph.poses[id] = T_map_place;
  std::vector<posegraph::Constraint> closures;
  std::vector<posegraph::ClosureDecision> previous;
  for (const Entry& e : entries_) {
    closures.push_back({e.edge.a, e.edge.b, e.edge.T_a_b, true});
    if (previous.size() < judged_) previous.push_back(e.decision);
  }
  const auto judged = posegraph::relaxRobustly(params_, graph, closures, previous);
  for (std::size_t i = 0; i < entries_.size(); ++i) entries_[i].decision = judged.decisions[i];
  judged_ = entries_.size();
  if (judged.relaxation.ending != posegraph::Ending::kFailed) poses_ = judged.relaxation.poses;
}

ClosureBook::Changes ClosureBook::apply(map::TopologicalMap& map) {
  Changes changes;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& e = entries_[i];
    if (e.decision.accepted == e.edge.id.valid()) continue;
    if (e.decision.accepted) {
      e.edge.id = map.addEdge(e.edge);
      if (proposed_ && i + 1 == entries_.size())
        changes.proposed = e.edge.id;
      else
        ++changes.restored;
    } else {
      map.removeEdge(e.edge.id);
      changes.dropped.push_back(e.edge.id);
      e.edge.id = {};
    }
  }
  if (!poses_.empty()) map.setPoses(poses_);
  poses_.clear();
  proposed_ = false;
  return changes;
}

}  // namespace engram::pipeline

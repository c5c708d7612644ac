// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/closure_book.h"

#include "engram/map/graph.h"

#include <algorithm>

namespace engram::pipeline {
namespace {

bool isClosure(map::EdgeType type) {
  return type == map::EdgeType::kLoop || type == map::EdgeType::kRecognition;
}

posegraph::ClosureDecision agreed() { return {true, posegraph::ClosureReason::kAgrees, 0, 0, 0}; }

}  // namespace

void ClosureBook::load(const map::TopologicalMap& map) {
  for (const auto& [id, edge] : map.edges())
    if (isClosure(edge.type)) enter(edge);
}

int ClosureBook::count(base::PlaceId a, base::PlaceId b) const {
  return static_cast<int>(std::count_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
    return std::minmax(e.edge.a, e.edge.b) == std::minmax(a, b);
  }));
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
  parts_.follow(map);
  poses_ = map::aligned(map, parts_, edge.a, edge.b, edge.T_a_b.T_a_b);
  const bool joins = !parts_.joined(edge.a, edge.b);
  edge.id = {};
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

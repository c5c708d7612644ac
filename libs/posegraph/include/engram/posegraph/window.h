// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/graph.h"

#include <functional>
#include <set>
#include <unordered_map>

namespace engram::posegraph {

/// A part of a graph that can be relaxed on its own.
struct Window {
  Graph graph;
  std::set<PlaceId> held;  ///< places of the rim: they stay, and stand for the rest of the graph
};

/// Constraints by place. Grows with its graph, so that a window costs what the window holds.
class Adjacency {
 public:
  Adjacency() = default;
  explicit Adjacency(const Graph& graph);

  /// The constraint at this position of Graph::constraints joins a and b.
  void add(std::size_t position, PlaceId a, PlaceId b);
  const std::vector<std::size_t>& at(PlaceId place) const;

 private:
  std::unordered_map<PlaceId, std::vector<std::size_t>> positions_;
};

using ConstraintsOf = std::function<std::vector<Constraint>(PlaceId)>;
using PoseOf = std::function<Eigen::Isometry3d(PlaceId)>;

/// The places up to `hops` constraints from `centre`, nearest first and at most `maxPlaces` of them, with
/// every constraint that one of them has. Places reached from those are the rim: present and held.
Window windowAround(PlaceId centre, int hops, int maxPlaces, const ConstraintsOf& constraintsOf,
                    const PoseOf& poseOf);
Window windowAround(const Graph& graph, const Adjacency& adjacency, PlaceId centre, int hops, int maxPlaces);

}  // namespace engram::posegraph

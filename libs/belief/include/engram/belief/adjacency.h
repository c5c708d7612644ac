// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace engram::belief {

/// Which places are next to which, and where they are. A value: the map makes it, the filter reads it.
struct Adjacency {
  std::vector<std::vector<int>> neighbours;  ///< of each place, ascending, without itself; symmetric
  std::vector<int> successor;    ///< the place that was made next on the way; -1 where the chain ends
  std::vector<int> predecessor;  ///< the inverse of `successor`; -1 where the chain begins
  /// x [m], y [m], heading [rad] of each place in the map, for `advance = odometry`; empty where the map has
  /// no metric.
  std::vector<Eigen::Vector3d> poses;

  std::size_t size() const { return neighbours.size(); }

  /// n places with these undirected edges; repeated edges and edges to itself are ignored. The chain goes
  /// from i to i + 1 where they share an edge. Throws std::invalid_argument for an end out of range.
  static Adjacency fromEdges(std::size_t n, std::span<const std::pair<int, int>> edges);

  /// The place `step` places along the chain (backwards when negative); -1 when it ends before.
  int along(int place, int step) const;
};

struct Hop {
  int place = -1;
  int hops = 0;
};

/// Breadth-first search with its working memory, so that one search costs only what it finds.
class HopSearch {
 public:
  explicit HopSearch(const Adjacency& adjacency) : adjacency_(adjacency), seen_(adjacency.size(), false) {}

  /// The places within `radius` hops, by distance, `place` itself first. Valid until the next call.
  std::span<const Hop> within(int place, int radius);

 private:
  const Adjacency& adjacency_;
  std::vector<bool> seen_;
  std::vector<Hop> found_;
};

/// Hops from a to b, or -1 when b is further than `radius` or cannot be reached.
int hopDistance(const Adjacency& adjacency, int a, int b, int radius);

}  // namespace engram::belief

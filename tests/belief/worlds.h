// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/belief/bayes_filter.h"

#include <utility>
#include <vector>

namespace engram::belief {

inline Adjacency chain(int n) {
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i + 1 < n; ++i) edges.emplace_back(i, i + 1);
  return Adjacency::fromEdges(static_cast<std::size_t>(n), edges);
}

inline Adjacency ring(int n) {
  std::vector<std::pair<int, int>> edges{{n - 1, 0}};
  for (int i = 0; i + 1 < n; ++i) edges.emplace_back(i, i + 1);
  return Adjacency::fromEdges(static_cast<std::size_t>(n), edges);
}

inline Adjacency randomGraph(int n, int extraEdges, base::Rng& rng) {
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i + 1 < n; ++i)
    if (rng.uniform() < 0.9) edges.emplace_back(i, i + 1);
  for (int k = 0; k < extraEdges; ++k)
    edges.emplace_back(rng.below(static_cast<std::uint32_t>(n)), rng.below(static_cast<std::uint32_t>(n)));
  return Adjacency::fromEdges(static_cast<std::size_t>(n), edges);
}

inline Likelihood randomLikelihood(std::size_t n, base::Rng& rng) {
  Likelihood l;
  for (std::size_t i = 0; i < n; ++i) l.places.push_back(rng.uniform());
  l.newPlace = rng.uniform();
  return l;
}

/// Shortest paths between all pairs (Floyd & Warshall): the oracle for everything that counts hops.
inline std::vector<std::vector<int>> allHops(const Adjacency& adjacency) {
  const std::size_t n = adjacency.size();
  std::vector<std::vector<int>> hops(n, std::vector<int>(n, 1 << 20));
  for (std::size_t i = 0; i < n; ++i) {
    hops[i][i] = 0;
    for (const int j : adjacency.neighbours[i]) hops[i][static_cast<std::size_t>(j)] = 1;
  }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) hops[i][j] = std::min(hops[i][j], hops[i][k] + hops[k][j]);
  return hops;
}

}  // namespace engram::belief

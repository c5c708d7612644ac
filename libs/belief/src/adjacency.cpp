// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/adjacency.h"

#include <algorithm>
#include <stdexcept>

namespace engram::belief {

Adjacency Adjacency::fromEdges(std::size_t n, std::span<const std::pair<int, int>> edges) {
  Adjacency out;
  out.neighbours.resize(n);
  out.successor.assign(n, -1);
  out.predecessor.assign(n, -1);
  for (const auto& [a, b] : edges) {
    if (std::min(a, b) < 0 || static_cast<std::size_t>(std::max(a, b)) >= n)
      throw std::invalid_argument("Adjacency: an edge to a place that does not exist");
    if (a == b) continue;
    out.neighbours[static_cast<std::size_t>(a)].push_back(b);
    out.neighbours[static_cast<std::size_t>(b)].push_back(a);
    if (std::abs(a - b) != 1) continue;
    out.successor[static_cast<std::size_t>(std::min(a, b))] = std::max(a, b);
    out.predecessor[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  for (auto& list : out.neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return out;
}

int Adjacency::along(int place, int step) const {
  const auto& next = step > 0 ? successor : predecessor;
  for (int k = std::abs(step); k > 0 && place >= 0; --k) place = next[static_cast<std::size_t>(place)];
  return place;
}

std::span<const Hop> HopSearch::within(int place, int radius) {
  found_.assign(1, {place, 0});
  seen_[static_cast<std::size_t>(place)] = true;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const Hop at = found_[i];
    if (at.hops == radius) break;  // by distance: all that follow are as far
    for (const int next : adjacency_.neighbours[static_cast<std::size_t>(at.place)]) {
      if (seen_[static_cast<std::size_t>(next)]) continue;
      seen_[static_cast<std::size_t>(next)] = true;
      found_.push_back({next, at.hops + 1});
    }
  }
  for (const auto& hop : found_) seen_[static_cast<std::size_t>(hop.place)] = false;
  return found_;
}

int hopDistance(const Adjacency& adjacency, int a, int b, int radius) {
  HopSearch search(adjacency);
  for (const auto& hop : search.within(a, radius))
    if (hop.place == b) return hop.hops;
  return -1;
}

}  // namespace engram::belief

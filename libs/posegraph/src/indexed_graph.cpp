// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "indexed_graph.h"

#include <algorithm>

namespace engram::posegraph {

IndexedGraph::IndexedGraph(const Graph& graph) {
  ids_.reserve(graph.poses.size());
  for (const auto& [id, T] : graph.poses) ids_.push_back(id);
  begin_.assign(ids_.size() + 1, 0);
  for (const Constraint& c : graph.constraints) {
    ends_.push_back({index(c.a), index(c.b)});
    ++begin_[ends_.back().to + 1];
    ++begin_[ends_.back().constraint + 1];
  }
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  arms_.resize(2 * ends_.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t k = 0; k < ends_.size(); ++k) {
    arms_[next[a(k)]++] = {b(k), k};
    arms_[next[b(k)]++] = {a(k), k};
  }
}

std::uint32_t IndexedGraph::index(PlaceId id) const {
  return static_cast<std::uint32_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
}

std::vector<char> IndexedGraph::anchors(const std::set<PlaceId>& held) const {
  std::vector<char> fixed(size(), 0), seen(size(), 0);
  for (const PlaceId id : held)
    if (std::binary_search(ids_.begin(), ids_.end(), id)) fixed[index(id)] = 1;
  std::vector<std::uint32_t> stack;
  for (std::uint32_t first = 0; first < size(); ++first) {
    if (seen[first]) continue;
    bool anyHeld = false;
    seen[first] = 1;
    for (stack.push_back(first); !stack.empty();) {
      const std::uint32_t at = stack.back();
      stack.pop_back();
      anyHeld |= fixed[at] != 0;
      for (const Arm& arm : arms(at)) {
        if (seen[arm.to]) continue;
        seen[arm.to] = 1;
        stack.push_back(arm.to);
      }
    }
    if (!anyHeld) fixed[first] = 1;
  }
  return fixed;
}

}  // namespace engram::posegraph

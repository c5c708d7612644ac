// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/graph.h"

#include <cstdint>
#include <set>
#include <span>
#include <vector>

namespace engram::posegraph {

/// The shape of a graph with places numbered 0 .. n-1 in the order of their ids: walks over it touch no tree.
class IndexedGraph {
 public:
  struct Arm {
    std::uint32_t to, constraint;
  };

  /// Every end of a constraint has a pose, see requireValid().
  explicit IndexedGraph(const Graph& graph);

  std::size_t size() const { return ids_.size(); }
  PlaceId id(std::size_t i) const { return ids_[i]; }
  /// The place has to be there.
  std::uint32_t index(PlaceId id) const;
  std::uint32_t a(std::size_t constraint) const { return ends_[constraint].to; }
  std::uint32_t b(std::size_t constraint) const { return ends_[constraint].constraint; }
  std::span<const Arm> arms(std::size_t i) const {
    return {arms_.data() + begin_[i], begin_[i + 1] - begin_[i]};
  }

  /// For each place whether it stays: the held ones, and the first one of every connected part without any.
  std::vector<char> anchors(const std::set<PlaceId>& held) const;

 private:
  std::vector<PlaceId> ids_;
  std::vector<Arm> ends_;  // a, b of each constraint
  std::vector<std::uint32_t> begin_;
  std::vector<Arm> arms_;
};

}  // namespace engram::posegraph

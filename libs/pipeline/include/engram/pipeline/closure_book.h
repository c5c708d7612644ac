// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/parts.h"
#include "engram/posegraph/robust.h"

#include <map>
#include <vector>

namespace engram::pipeline {

/// Every metric loop closure that was proposed while mapping, whether the map holds it or not. One that is
/// refused today may be confirmed by the next ones, and one that is in the map may be denied by them.
class ClosureBook {
 public:
  explicit ClosureBook(const posegraph::RelaxerParams& params) : params_(params) {}

  /// The closures that a map holds already count as accepted.
  void load(const map::TopologicalMap& map);
  bool empty() const { return entries_.empty(); }
  /// How many join these two places, in whichever direction.
  int count(base::PlaceId a, base::PlaceId b) const;

  /// Enters an edge that the map holds already and that no measurement speaks against yet.
  void enter(const map::Edge& edge);
  /// Judges one more closure, together with all that were proposed before: chi-square against the estimate,
  /// consistency with the others, and the same again on the relaxed graph. Returns what became of it.
  /// Nothing changes in the map before apply(). A closure that is the first to join two parts of the map is
  /// accepted: there is nothing yet that could deny it.
  posegraph::ClosureDecision propose(const map::TopologicalMap& map, map::Edge edge);
  /// Judges all again, at the end of a drive.
  void review(const map::TopologicalMap& map);

  /// What apply() did to the map.
  struct Changes {
    std::vector<base::EdgeId> dropped;  ///< edges that the graph denies
    int restored = 0;                   ///< closures refused before that are in now
    base::EdgeId proposed;              ///< the edge of the last propose(); invalid when it was refused
  };
  /// Brings the edges and poses of the map to what was last judged.
  Changes apply(map::TopologicalMap& map);

 private:
  struct Entry {
    map::Edge edge;  ///< its id is valid while the map holds it
    posegraph::ClosureDecision decision;
  };

  void judge(const map::TopologicalMap& map);
  posegraph::Graph trusted(const map::TopologicalMap& map) const;

  posegraph::RelaxerParams params_;
  map::Parts parts_;
  std::vector<Entry> entries_;
  std::size_t judged_ = 0;  ///< entries of which the decision is known
  bool proposed_ = false;   ///< the last entry came from propose() and is not applied yet
  std::map<base::PlaceId, Eigen::Isometry3d> poses_;  ///< for apply()
};

}  // namespace engram::pipeline

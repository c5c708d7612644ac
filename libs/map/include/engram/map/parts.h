// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"

#include <map>
#include <set>

namespace engram::map {

/// The parts of a map: places that passages join. Between parts nothing is measured, and a weak edge is a
/// guess. A reader of the map's changes; what follows of a change costs what has changed, but two parts that
/// become one cost the places of the smaller, and a passage that is taken out between places that stay costs
/// the map.
class Parts {
 public:
  /// Must be called before a question, whenever the map may have changed.
  void follow(const TopologicalMap& map);

  /// Whether passages lead from a to b. Throws std::out_of_range for a place that is not in the map.
  bool joined(PlaceId a, PlaceId b) const { return nameOf_.at(a) == nameOf_.at(b); }
  /// The places of the part that holds this one, rising.
  const std::set<PlaceId>& placesOf(PlaceId place) const { return members_.at(nameOf_.at(place)); }

 private:
  void add(PlaceId place);
  void join(PlaceId a, PlaceId b);
  void remove(PlaceId place);
  void rebuild(const TopologicalMap& map);

  Cursor cursor_;
  bool started_ = false;
  std::map<PlaceId, PlaceId> nameOf_;  // of the part: some place that it has or had
  std::map<PlaceId, std::set<PlaceId>> members_;
  std::map<EdgeId, std::pair<PlaceId, PlaceId>> passages_;
};

/// Two parts of the map become one by T_a_b: the part with the later first place moves to where that puts it.
/// Poses of all its places; empty when a and b are in one part. Changes nothing.
std::map<PlaceId, Eigen::Isometry3d> aligned(const TopologicalMap& map, const Parts& parts, PlaceId a,
                                             PlaceId b, const Eigen::Isometry3d& T_a_b);

/// A weak edge has served once passages join its two sides (K-11, K-E11). Returns whether any went.
bool dropJoinedWeakEdges(TopologicalMap& map, Parts& parts);

}  // namespace engram::map

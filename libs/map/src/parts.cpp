// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/parts.h"

#include "engram/types/se3.h"

#include <algorithm>

namespace engram::map {

void Parts::follow(const TopologicalMap& map) {
  if (!started_) return rebuild(map);
  const MapChanges changes = map.changesSince(cursor_);
  for (const PlaceId id : changes.places) add(id);
  for (const PlaceId id : changes.removedPlaces) remove(id);
  bool cut = false;
  for (const EdgeId id : changes.removedEdges) {
    const auto gone = passages_.extract(id);
    if (gone) cut |= nameOf_.contains(gone.mapped().first) && nameOf_.contains(gone.mapped().second);
  }
  if (cut) return rebuild(map);
  for (const EdgeId id : changes.edges) {
    const Edge& edge = map.edge(id);
    if (isPassage(edge.type) && passages_.try_emplace(id, edge.a, edge.b).second) join(edge.a, edge.b);
  }
}

void Parts::add(PlaceId place) {
  if (nameOf_.try_emplace(place, place).second) members_[place] = {place};
}

/// The smaller part goes into the larger one.
void Parts::join(PlaceId a, PlaceId b) {
  PlaceId kept = nameOf_.at(a), gone = nameOf_.at(b);
  if (kept == gone) return;
  if (members_.at(kept).size() < members_.at(gone).size()) std::swap(kept, gone);
  for (const PlaceId id : members_.at(gone)) nameOf_[id] = kept;
  members_.at(kept).merge(members_.at(gone));
  members_.erase(gone);
}

/// What is left stays joined: upkeep mends the graph around a place that goes.
void Parts::remove(PlaceId place) {
  const auto gone = nameOf_.extract(place);
  if (!gone) return;
  auto& left = members_.at(gone.mapped());
  left.erase(place);
  if (left.empty()) members_.erase(gone.mapped());
}

void Parts::rebuild(const TopologicalMap& map) {
  *this = {};
  started_ = true;
  cursor_ = map.now();
  for (const auto& [id, place] : map.places()) add(id);
  for (const auto& [id, edge] : map.edges()) {
    if (!isPassage(edge.type)) continue;
    passages_.try_emplace(id, edge.a, edge.b);
    join(edge.a, edge.b);
  }
}

std::map<PlaceId, Eigen::Isometry3d> aligned(const TopologicalMap& map, const Parts& parts, PlaceId a,
                                             PlaceId b, const Eigen::Isometry3d& T_a_b) {
  if (parts.joined(a, b)) return {};
  const auto &partA = parts.placesOf(a), &partB = parts.placesOf(b);
  const bool moveA = *partB.begin() < *partA.begin();
  const Eigen::Isometry3d T_map_a = map.place(a).T_map_place, T_map_b = map.place(b).T_map_place;
  const Eigen::Isometry3d T_new_old =
      moveA ? T_map_b * T_a_b.inverse() * T_map_a.inverse() : T_map_a * T_a_b * T_map_b.inverse();
  std::map<PlaceId, Eigen::Isometry3d> moved;
  for (const PlaceId id : moveA ? partA : partB)
    moved[id] = types::rigid(T_new_old * map.place(id).T_map_place);
  return moved;
}

bool dropJoinedWeakEdges(TopologicalMap& map, Parts& parts) {
  parts.follow(map);
  std::vector<EdgeId> joined;
  for (const auto& [id, edge] : map.edges())
    if (edge.type == EdgeType::kWeak && parts.joined(edge.a, edge.b)) joined.push_back(id);
  for (const EdgeId id : joined) map.removeEdge(id);
  return !joined.empty();
}

}  // namespace engram::map

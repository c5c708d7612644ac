// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/journal.h"

#include <algorithm>

namespace engram::map {
namespace {

/// Outdated entries that are carried along before they are worth a sweep.
constexpr std::size_t kSlack = 64;

template <class Id>
void add(std::vector<Id>& ids, std::size_t id) {
  ids.push_back(Id(static_cast<std::uint32_t>(id)));
}

void add(MapChanges& changes, Journal::Kind kind, std::size_t id) {
  using Kind = Journal::Kind;
  switch (kind) {
    case Kind::kPlace:
      return add(changes.places, id);
    case Kind::kMemory:
      return add(changes.memories, id);
    case Kind::kView:
      return add(changes.views, id);
    case Kind::kEdge:
      return add(changes.edges, id);
    case Kind::kRemovedPlace:
      return add(changes.removedPlaces, id);
    case Kind::kRemovedView:
      return add(changes.removedViews, id);
    case Kind::kRemovedEdge:
      return add(changes.removedEdges, id);
    case Kind::kMovedPathPoint:
      return changes.movedPathPoints.push_back(id);
    case Kind::kForgottenPath:
      changes.pathForgotten = true;
  }
}

}  // namespace

bool MapChanges::empty() const {
  return places.empty() && memories.empty() && views.empty() && edges.empty() && removedPlaces.empty() &&
         removedViews.empty() && removedEdges.empty() && movedPathPoints.empty() && !pathForgotten &&
         firstNewPathPoint == pathSize;
}

void Journal::note(Kind kind, std::size_t id) {
  const Key key{kind, id};
  latest_[key] = ++now_;
  entries_.push_back({now_, key});
  if (entries_.size() > 2 * latest_.size() + kSlack) compact();
}

void Journal::drop(Kind kind, std::size_t id) { latest_.erase({kind, id}); }

void Journal::compact() {
  std::erase_if(entries_, [this](const Entry& e) {
    const auto at = latest_.find(e.key);
    return at == latest_.end() || at->second != e.sequence;
  });
}

MapChanges Journal::since(std::uint64_t sequence) const {
  const auto first = std::upper_bound(entries_.begin(), entries_.end(), sequence,
                                      [](std::uint64_t s, const Entry& e) { return s < e.sequence; });
  std::vector<Key> keys;
  for (auto it = first; it != entries_.end(); ++it) {
    const auto at = latest_.find(it->key);
    if (at != latest_.end() && at->second == it->sequence) keys.push_back(it->key);
  }
  std::sort(keys.begin(), keys.end());
  MapChanges changes;
  for (const auto& [kind, id] : keys) add(changes, kind, id);
  return changes;
}

}  // namespace engram::map

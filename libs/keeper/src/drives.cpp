// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/keeper/edits.h"
#include "surgeon.h"

#include <set>

namespace engram::keeper {
namespace {

/// Places of a session that another one has views of, or drove by.
std::set<map::PlaceId> visitedByOthers(const map::MapContent& content, int session) {
  std::set<map::PlaceId> visited;
  for (const auto& [id, view] : content.views)
    if (view.session != session) visited.insert(view.place);
  for (const map::PathPoint& point : content.path)
    if (point.session != session) visited.insert(point.anchor);
  return visited;
}

void dropSession(map::MapContent& content, int session, DroppedDrive& dropped) {
  const std::set<map::PlaceId> others = visitedByOthers(content, session);
  std::set<map::PlaceId> gone;
  for (const auto& [id, place] : content.places) {
    if (place.session != session) continue;
    if (others.contains(id))
      ++dropped.kept;
    else
      gone.insert(id);
  }
  if (gone.size() == content.places.size())
    throw base::Error(
        "no other drive has been at any place: without this one the map is empty. Delete the map instead");
  dropped.places = gone.size();
  dropped.pathPoints = static_cast<std::size_t>(
      std::erase_if(content.path, [&](const map::PathPoint& point) { return point.session == session; }));
  dropped.views = static_cast<std::size_t>(
      std::erase_if(content.views, [&](const auto& item) { return item.second.session == session; }));
  removePlaces(content, gone, true);
}

}  // namespace

DroppedDrive dropDrive(store::WholeMap& map, std::uint32_t number) {
  if (number >= map.drives.size())
    throw base::Error("there is no drive " + std::to_string(number) + ": the map has " +
                      std::to_string(map.drives.size()) + ", numbered from 0");
  DroppedDrive dropped;
  const store::Drive drive = map.drives[number];
  if (drive.session >= 0) dropSession(map.content, drive.session, dropped);
  const std::uint64_t from = drive.firstRecord;
  const std::uint64_t to = number + 1 < map.drives.size() ? map.drives[number + 1].firstRecord
                                                          : map.firstRecord + map.records.size();
  dropped.records = dropRecords(map, [&](std::uint64_t i) { return i >= from && i < to; });
  map.drives.erase(map.drives.begin() + number);
  for (std::size_t i = 0; i < map.drives.size(); ++i) map.drives[i].id = static_cast<std::uint32_t>(i);
  forgetPlaces(map.records, map.content);
  return dropped;
}

}  // namespace engram::keeper

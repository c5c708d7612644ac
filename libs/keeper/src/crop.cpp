// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/keeper/edits.h"
#include "surgeon.h"

#include <cstdio>
#include <set>

namespace engram::keeper {
namespace {

std::string extentOf(const map::MapContent& content) {
  Eigen::AlignedBox2d box;
  for (const auto& [id, place] : content.places) box.extend(place.T_map_place.translation().head<2>().eval());
  char text[160];
  std::snprintf(text, sizeof text, "x %.1f to %.1f, y %.1f to %.1f", box.min().x(), box.max().x(),
                box.min().y(), box.max().y());
  return text;
}

}  // namespace

Cropped crop(store::WholeMap& map, const Region& region) {
  std::set<map::PlaceId> gone;
  for (const auto& [id, place] : map.content.places)
    if (!region.contains(place.T_map_place.translation())) gone.insert(id);
  if (gone.size() == map.content.places.size())
    throw base::Error("no place is in this region; those of the map are at " + extentOf(map.content) +
                      " [m]");
  Cropped cropped{gone.size(), map.content.path.size(), 0};
  removePlaces(map.content, gone, false);
  cropped.pathPoints -= map.content.path.size();
  // An image that was taken outside says where the robot was.
  cropped.records = dropRecords(map, [&](std::uint64_t i) {
    const types::FrameReport& r = map.records[i - map.firstRecord];
    if (r.pose) return !region.contains(r.pose->T_map_robot.translation());
    return r.place.valid() && !map.content.places.contains(r.place);
  });
  forgetPlaces(map.records, map.content);
  return cropped;
}

}  // namespace engram::keeper

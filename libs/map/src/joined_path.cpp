// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/joined_path.h"

#include "engram/map/parts.h"

namespace engram::map {

JoinedPath joinedPath(const TopologicalMap& map, const std::vector<PathPoint>& points) {
  Parts parts;
  parts.follow(map);
  std::vector<std::pair<PlaceId, std::vector<PathPoint>>> found;  // some place of a part, and what lies in it
  std::size_t all = 0;
  for (const PathPoint& point : points) {
    if (!map.places().contains(point.anchor)) continue;
    ++all;
    auto at = found.begin();
    while (at != found.end() && !parts.joined(at->first, point.anchor)) ++at;
    if (at == found.end()) at = found.insert(at, {point.anchor, {}});
    at->second.push_back(point);
  }
  JoinedPath joined;
  for (auto& [place, within] : found)
    if (within.size() > joined.points.size()) joined.points = std::move(within);
  if (all > 0) joined.apart = 1.0 - static_cast<double>(joined.points.size()) / static_cast<double>(all);
  return joined;
}

}  // namespace engram::map

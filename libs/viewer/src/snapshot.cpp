// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "snapshot.h"

#include <algorithm>

namespace engram::viewer {
namespace {

constexpr std::size_t kPathShown = 400;  // points

/// Upkeep may take a place out again with the image that made it.
bool isThere(base::PlaceId place, const map::TopologicalMap& map) {
  return place.valid() && map.places().count(place) > 0;
}

MapSketch sketch(const map::TopologicalMap& map, const types::FrameReport& report) {
  MapSketch s;
  const auto at = [](const Eigen::Isometry3d& T) -> Eigen::Vector3f { return T.translation().cast<float>(); };
  s.places.reserve(map.places().size());
  for (const auto& [id, place] : map.places())
    s.places.push_back({at(place.T_map_place), id.value, id == report.place});
  s.edges.reserve(map.edges().size());
  for (const auto& [id, edge] : map.edges())
    s.edges.push_back({at(map.place(edge.a).T_map_place), at(map.place(edge.b).T_map_place), edge.type});
  const auto& path = map.path();
  for (std::size_t i = path.size() - std::min(path.size(), kPathShown); i < path.size(); ++i)
    s.path.push_back(at(map.T_map_robot(path[i])));
  if (!path.empty() && path.back().stamp == report.stamp)
    s.robot = s.path.back();
  else if (isThere(report.place, map))  // while localising no path grows
    s.robot = at(map.place(report.place).T_map_place);
  return s;
}

}  // namespace

Snapshot Snapper::take(const types::Frame& frame, const types::FrameReport& report, RobotState state,
                       const map::TopologicalMap& map) {
  Snapshot s;
  s.image = frame.image;  // shared: frames are not written to
  s.report = report;
  s.state = state;
  s.map = sketch(map, report);
  if (isThere(report.place, map)) s.memory = *map.place(report.place).memory;
  const base::PlaceId shown = report.place.valid() ? report.place : report.bestGuess;
  if (const auto* jpeg = thumbnailOf(shown, map)) s.matchedJpeg = *jpeg;
  return s;
}

const std::vector<std::uint8_t>* Snapper::thumbnailOf(base::PlaceId place, const map::TopologicalMap& map) {
  const auto& views = map.views();
  for (auto at = lastView_ ? views.upper_bound(*lastView_) : views.begin(); at != views.end(); ++at) {
    lastView_ = at->first;
    if (!at->second.jpeg.empty()) thumbnails_.emplace(at->second.place, at->first);
  }
  const auto found = thumbnails_.find(place);
  if (found == thumbnails_.end()) return nullptr;
  const auto view = views.find(found->second);
  return view == views.end() ? nullptr : &view->second.jpeg;
}

}  // namespace engram::viewer

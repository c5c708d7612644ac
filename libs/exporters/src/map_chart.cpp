// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_chart.h"

#include "engram/charts/drawing.h"
#include "map_colours.h"

#include <algorithm>

namespace engram::exporters {
namespace {

using charts::Drawing;
using charts::LegendEntry;
using charts::LegendKey;

Eigen::Vector2d onGround(const Eigen::Isometry3d& T) { return T.translation().head<2>(); }

void drawPaths(Drawing& drawing, const map::TopologicalMap& map) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < map.path().size(); ++i) {
    const map::PathPoint& p = map.path()[i];
    points.push_back(onGround(map.T_map_robot(p)));
    if (i + 1 < map.path().size() && map.path()[i + 1].session == p.session) continue;
    drawing.polyline(points, charts::categoryColour(static_cast<std::size_t>(p.session)), 1.0);
    points.clear();
  }
}

void drawEdges(Drawing& drawing, const map::TopologicalMap& map) {
  for (const auto& [id, e] : map.edges())
    drawing.line(onGround(map.place(e.a).T_map_place), onGround(map.place(e.b).T_map_place),
                 edgeColour(e.type), e.type == map::EdgeType::kOdometry ? 1.2 : 2.2, !map::isPassage(e.type));
}

void drawPlaces(Drawing& drawing, const map::TopologicalMap& map) {
  constexpr std::size_t kMaxNumbers = 40;
  const std::size_t every = map.places().size() / kMaxNumbers + 1;
  const double radius = map.places().size() > 400 ? 2.5 : 4.5;
  const double most = largestLongTerm(map.content());
  std::size_t i = 0;
  for (const auto& [id, place] : map.places()) {
    const std::size_t longTerm = place.memory->longTerm().size();
    const std::string name = std::to_string(id.value);
    drawing.dot(onGround(place.T_map_place), radius, charts::viridis(static_cast<double>(longTerm) / most),
                "place " + name + ": " + std::to_string(longTerm) + " long-term, " +
                    std::to_string(place.memory->states.size() - longTerm) + " short-term features, " +
                    std::to_string(place.memory->updates) + " views learnt, made from " + place.createdLabel);
    if (i++ % every == 0) drawing.words(onGround(place.T_map_place), name, 10);
  }
}

std::vector<LegendEntry> legendOf(const map::TopologicalMap& map) {
  std::vector<LegendEntry> legend;
  for (const map::EdgeType type : kEdgeTypes)
    if (std::any_of(map.edges().begin(), map.edges().end(),
                    [&](const auto& e) { return e.second.type == type; }))
      legend.push_back({map::toString(type), edgeColour(type),
                        !map::isPassage(type) ? LegendKey::kDashed : LegendKey::kLine});
  legend.push_back({"place: few", charts::viridis(0), LegendKey::kSwatch});
  legend.push_back({"many long-term features", charts::viridis(1), LegendKey::kSwatch});
  return legend;
}

}  // namespace

std::string mapChart(const map::TopologicalMap& map) {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = low;
  bool first = true;
  const auto add = [&](const Eigen::Vector2d& p) {
    low = first ? p : low.cwiseMin(p).eval();
    high = first ? p : high.cwiseMax(p).eval();
    first = false;
  };
  for (const auto& [id, place] : map.places()) add(onGround(place.T_map_place));
  for (const auto& p : map.path()) add(onGround(map.T_map_robot(p)));
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.05 * std::max((high - low).maxCoeff(), 1.0));
  // As high as the map needs, within reason.
  const Eigen::Vector2d size = high - low + 2 * margin;
  const double height = std::clamp(1000 * size.y() / size.x() + 98, 338.0, 818.0);
  Drawing drawing(
      {.title = "Map from above", .xLabel = "x [m]", .yLabel = "y [m]", .width = 1080, .height = height},
      {.low = low - margin, .high = high + margin, .equalScale = true, .legend = legendOf(map)});
  drawPaths(drawing, map);
  drawEdges(drawing, map);
  drawPlaces(drawing, map);
  return std::move(drawing).finish();
}

}  // namespace engram::exporters

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/neighbourhood.h"

#include "certainty.h"

#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <tuple>

namespace engram::upkeep {
namespace {

bool isNear(const types::RelPose& T, const NeighbourhoodParams& params) {
  return T.T_a_b.translation().norm() <= params.distance &&
         Eigen::AngleAxisd(T.T_a_b.linear()).angle() <= params.angle;
}

}  // namespace

/// Dijkstra's algorithm over variances, bounded in space and in uncertainty.
std::vector<NearPlace> neighbourhood(const map::TopologicalMap& map, PlaceId view,
                                     const NeighbourhoodParams& params) {
  const double maxVariance = params.search_sigma * params.search_sigma;
  using Step = std::tuple<double, PlaceId, PlaceId, map::EdgeId>;  // variance so far, place, parent, edge
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue;
  std::map<PlaceId, types::RelPose> T_view;  // of the places reached

  const auto reach = [&](double sum, PlaceId place, const types::RelPose& T_view_place) {
    T_view[place] = T_view_place;
    if (T_view_place.T_a_b.translation().norm() > params.search_distance) return;
    for (const map::Neighbour& n : map.neighbours(place)) {
      const types::RelPose& T = map.edge(n.edge).T_a_b;
      if (!map::isPassage(n.type) || !T.hasScale || T_view.contains(n.place)) continue;
      queue.emplace(sum + variance(T), n.place, place, n.edge);
    }
  };
  reach(0, view, {.cov = types::Matrix6d::Zero()});
  while (!queue.empty()) {
    const auto [sum, place, parent, edge] = queue.top();
    queue.pop();
    if (T_view.contains(place)) continue;
    const types::RelPose T = types::compose(T_view.at(parent), seenFrom(parent, map.edge(edge)));
    if (T.cov.topLeftCorner<3, 3>().trace() <= maxVariance) reach(sum, place, T);
  }

  std::vector<NearPlace> near;
  for (const auto& [place, T] : T_view)
    if (place != view && isNear(T, params)) near.push_back({place, T});
  return near;
}

}  // namespace engram::upkeep

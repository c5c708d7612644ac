// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/map/topological_map.h"
#include "engram/posegraph/graph.h"

#include <cmath>
#include <vector>

namespace engram::upkeep {

using base::PlaceId;
using map::EdgeType;
using map::TopologicalMap;

inline PlaceId p(std::size_t v) { return PlaceId(static_cast<std::uint32_t>(v)); }

inline Eigen::Isometry3d planar(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0;
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// A random covariance with standard deviations around `sigma`, correlated.
inline types::Matrix6d randomCovariance(base::Rng& rng, double sigma) {
  types::Matrix6d A = types::Matrix6d::Identity();
  for (int i = 0; i < 36; ++i) A(i) += rng.normal(0, 0.3);
  const types::Matrix6d cov = sigma * sigma * A * A.transpose();
  return 0.5 * (cov + cov.transpose());
}

inline Eigen::Matrix<double, 6, 1> randomMotion(base::Rng& rng, double metres, double radians) {
  Eigen::Matrix<double, 6, 1> v;
  for (int i = 0; i < 6; ++i) v[i] = rng.normal(0, i < 3 ? metres : radians);
  return v;
}

/// Joins two places by an edge that measured the poses that they have in the map.
inline map::EdgeId join(TopologicalMap& map, PlaceId a, PlaceId b, EdgeType type,
                        const types::Matrix6d& cov) {
  map::Edge edge{.type = type, .a = a, .b = b};
  edge.T_a_b = {map.place(a).T_map_place.inverse() * map.place(b).T_map_place, cov};
  return map.addEdge(edge);
}

inline types::Matrix6d isotropic(double sigma) { return types::Matrix6d::Identity() * sigma * sigma; }

/// Places at random poses.
inline TopologicalMap scattered(base::Rng& rng, std::uint32_t places) {
  TopologicalMap map;
  for (std::uint32_t i = 0; i < places; ++i) {
    map::Place place;
    place.T_map_place = posegraph::expSe3(randomMotion(rng, 1.0, 0.5));
    map.addPlace(place);
  }
  return map;
}

/// The same with an edge from each to one of those before it, and further edges; some of them are weak.
inline TopologicalMap randomMap(base::Rng& rng, std::uint32_t places, std::uint32_t edges, double weak) {
  TopologicalMap map = scattered(rng, places);
  for (std::uint32_t e = 1; e < places + edges; ++e) {
    const auto b = e < places ? e : rng.below(places), a = rng.below(e < places ? e : places);
    if (a == b) continue;
    const bool isWeak = rng.uniform() < weak;
    join(map, p(a), p(b), isWeak ? EdgeType::kWeak : EdgeType::kOdometry,
         randomCovariance(rng, isWeak ? 1000 : rng.uniform(0.01, 0.2)));
  }
  return map;
}

}  // namespace engram::upkeep

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/map/topological_map.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace engram::testing {

/// Random features as an extractor with int8 descriptors and a camera gives them.
inline types::Features randomFeatures(base::Rng& rng, int n, int dim = 64) {
  types::Features f;
  f.descriptors = types::Descriptors(types::DescriptorKind::kInt8, dim);
  f.descriptors.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const auto index = static_cast<std::size_t>(i);
    f.keypoints.push_back({.x = static_cast<float>(rng.uniform(0, 640)),
                           .y = static_cast<float>(rng.uniform(0, 480)),
                           .size = static_cast<float>(rng.uniform(8, 60)),
                           .angle = static_cast<float>(rng.uniform(-3.1, 3.1)),
                           .response = static_cast<float>(rng.uniform(0.001, 0.2)),
                           .sign = static_cast<std::int8_t>(rng.uniform() < 0.5 ? -1 : 1)});
    auto* row = f.descriptors.mutableRow(index);
    for (int d = 0; d < dim; ++d)
      row[d] = static_cast<std::byte>(static_cast<std::int8_t>(std::clamp(rng.normal(0, 31), -127.0, 127.0)));
    f.bearings.push_back(
        Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized().cast<float>());
  }
  return f;
}

inline memory::PlaceMemory randomMemory(base::Rng& rng, int n, int historyLength, int dim = 64) {
  memory::PlaceMemory m;
  m.features = randomFeatures(rng, n, dim);
  for (int i = 0; i < n; ++i) {
    memory::FeatureState s;
    s.id = m.nextFeatureId++;
    s.value = static_cast<float>(rng.uniform(0, 4));
    s.age = static_cast<std::uint16_t>(rng.below(9));
    s.stage = rng.uniform() < 0.4 ? memory::Stage::kLongTerm : memory::Stage::kShortTerm;
    for (int h = 0; h < historyLength; ++h) s.history.push_back(static_cast<std::uint8_t>(rng.below(256)));
    m.states.push_back(s);
  }
  m.updates = static_cast<std::uint32_t>(historyLength);
  return m;
}

inline Eigen::Isometry3d planarPose(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0;
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

inline types::RelPose relPose(const Eigen::Isometry3d& T_a_b, double sigma = 0.1) {
  types::RelPose p;
  p.T_a_b = T_a_b;
  p.cov = types::Matrix6d::Identity() * sigma * sigma;
  return p;
}

/// A closed ring of n places on a circle of radius 10 m, driven once: odometry edges, one loop edge, views
/// and path.
inline map::TopologicalMap ringMap(int n, int features = 20, std::uint64_t seed = 7) {
  base::Rng rng(seed);
  map::TopologicalMap m;
  std::vector<map::PlaceId> ids;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n;
    map::Place p;
    p.T_map_place = planarPose(10 * std::cos(angle), 10 * std::sin(angle), angle + M_PI / 2);
    p.memory = randomMemory(rng, features, 3);
    p.createdStamp = 100 + i;
    p.createdIndex = static_cast<std::uint64_t>(i);
    p.createdLabel = "image_" + std::to_string(i) + ".png";
    ids.push_back(m.addPlace(std::move(p)));
    m.addView(
        {.place = ids.back(), .stamp = 100.0 + i, .frameIndex = static_cast<std::uint64_t>(i), .label = "v"});
    m.addPathPoint({.session = 0, .stamp = 100.0 + i, .anchor = ids.back()});
  }
  for (int i = 0; i < n; ++i) {
    const auto a = ids[static_cast<std::size_t>(i)], b = ids[static_cast<std::size_t>((i + 1) % n)];
    m.addEdge({.type = i + 1 < n ? map::EdgeType::kOdometry : map::EdgeType::kLoop,
               .a = a,
               .b = b,
               .T_a_b = relPose(m.place(a).T_map_place.inverse() * m.place(b).T_map_place),
               .correspondences = {{0, 1}, {2, 3}}});
  }
  return m;
}

}  // namespace engram::testing

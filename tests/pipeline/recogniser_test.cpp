// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/recogniser.h"

#include "engram/base/rng.h"
#include "engram/memory/static_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>

namespace engram::pipeline {
namespace {

types::Features randomView(base::Rng& rng) {
  types::Features view;
  view.descriptors = types::Descriptors(types::DescriptorKind::kFloat, 64);
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix<float, 64, 1> d;
    for (int k = 0; k < 64; ++k) d[k] = static_cast<float>(rng.normal());
    d.normalize();
    view.descriptors.append(std::as_bytes(std::span<const float>(d.data(), 64)));
    view.keypoints.push_back({static_cast<float>(i), 0, 5, 0, 1, 1});
  }
  view.descriptors = types::quantised(view.descriptors);
  return view;
}

Eigen::Isometry3d planar(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0;
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// A map that changes at random: places come, learn nothing, move, and edges come and go.
class ChangingMap {
 public:
  void change() {
    const auto n = static_cast<std::uint32_t>(map.places().size());
    const auto kind = rng_.below(5);
    if (n < 4 || (kind == 0 && n < 25)) return addPlace();
    const base::PlaceId a(rng_.below(n)), b((a.value + 1 + rng_.below(n - 1)) % n);
    if (kind == 1) return map.setPose(a, planar(rng_.normal(), rng_.normal(), rng_.normal()));
    if (kind == 2 && !map.edges().empty())
      return map.removeEdge(
          std::next(map.edges().begin(), rng_.below(static_cast<std::uint32_t>(map.edges().size())))->first);
    map::Edge edge{.a = a, .b = b};
    if (kind == 3) edge.type = map::EdgeType::kLoop;
    if (rng_.below(6) == 0) edge.type = map::EdgeType::kWeak;
    edge.T_a_b.T_a_b = planar(rng_.uniform(0.1, 2), 0, 0);
    map.addEdge(edge);
  }
  types::Features anyView() {
    const auto n = static_cast<std::uint32_t>(map.places().size());
    return n == 0 ? randomView(rng_) : map.place(base::PlaceId(rng_.below(n))).memory->features;
  }
  map::TopologicalMap map;

 private:
  void addPlace() {
    map::Place place;
    place.memory = memory::Static().start(randomView(rng_));
    const base::PlaceId made = map.addPlace(std::move(place));
    if (made.value > 0) map.addEdge({.a = base::PlaceId(made.value - 1), .b = made});
  }
  base::Rng rng_{5};
};

/// What a recogniser reads in the journal is what it would find in the whole map, to the last bit, with every
/// model of motion.
TEST(Recogniser, FollowingAMapIsAsGoodAsLoadingIt) {
  for (const std::string advance : {"none", "learned", "odometry"}) {
    PipelineParams params;
    params.belief.advance = advance;
    ChangingMap changing;
    Recogniser following(params, Recogniser::Mode::kLocalisation);
    following.load(changing.map);
    for (int i = 0; i < 300; ++i) {
      changing.change();
      if (i % 7 != 0) continue;
      Recogniser loaded(params, Recogniser::Mode::kLocalisation);
      loaded.load(changing.map);
      following.follow(changing.map);
      following.restart();
      for (int k = 0; k < 3; ++k) {
        const types::Features view = changing.anyView();
        const Travel travel{0.7, {0.6, 0.1}, 0.2};
        const auto a = following.recognise(changing.map, view, travel),
                   b = loaded.recognise(changing.map, view, travel);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t h = 0; h < a.size(); ++h) {
          ASSERT_EQ(a[h].place, b[h].place) << advance << ' ' << i;
          ASSERT_EQ(a[h].posterior, b[h].posterior) << advance << ' ' << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace engram::pipeline

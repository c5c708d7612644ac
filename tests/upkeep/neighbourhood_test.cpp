// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/neighbourhood.h"

#include "engram/base/error.h"
#include "graph_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace engram::upkeep {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::uint32_t> idsOf(const std::vector<NearPlace>& near) {
  std::vector<std::uint32_t> ids;
  for (const NearPlace& n : near) ids.push_back(n.place.value);
  return ids;
}

TopologicalMap chain(const std::vector<Eigen::Isometry3d>& poses, double sigma = 0.01) {
  TopologicalMap map;
  for (const auto& T : poses) {
    map::Place place;
    place.T_map_place = T;
    map.addPlace(place);
  }
  for (std::size_t i = 1; i < poses.size(); ++i)
    join(map, p(i - 1), p(i), EdgeType::kOdometry, isotropic(sigma));
  return map;
}

std::vector<Eigen::Isometry3d> straight(int n, double step) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < n; ++i) poses.push_back(planar(i * step, 0, 0));
  return poses;
}

TEST(Neighbourhood, HoldsWhatIsWithinDistanceAndAngle) {
  auto poses = straight(9, 0.2);
  poses[3] = poses[3] * planar(0, 0, 0.17);   // 9.7 degrees
  poses[5] = poses[5] * planar(0, 0, -0.18);  // 10.3 degrees
  const auto map = chain(poses);
  EXPECT_THAT(idsOf(neighbourhood(map, p(4), {})), ElementsAre(2u, 3u, 6u));
  EXPECT_THAT(idsOf(neighbourhood(map, p(4), {.distance = 0.39})), ElementsAre(3u));
  EXPECT_THAT(idsOf(neighbourhood(map, p(4), {.angle = M_PI})), ElementsAre(2u, 3u, 5u, 6u));
  const auto near = neighbourhood(map, p(4), {});
  EXPECT_TRUE(near[1].T_view_place.T_a_b.isApprox(poses[4].inverse() * poses[3], 1e-12));
  EXPECT_THROW(neighbourhood(map, p(20), {}), base::Error);
}

/// K-26: the end of a long loop is beside its beginning in the map, but nothing has joined the two.
TEST(Neighbourhood, IsThatOfTheGraphNotOfTheMap) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 100; ++i)
    poses.push_back(planar(5 * std::cos(i * 0.0628), 5 * std::sin(i * 0.0628), 0));
  auto map = chain(poses);
  ASSERT_LT((poses[99].translation() - poses[0].translation()).norm(), 0.35);
  EXPECT_THAT(idsOf(neighbourhood(map, p(0), {})), ElementsAre(1u));
  join(map, p(99), p(1), EdgeType::kLoop, isotropic(0.01));
  EXPECT_THAT(idsOf(neighbourhood(map, p(0), {})), ElementsAre(1u, 99u));

  // The other way round: poses that were not relaxed yet do not hide what the edges say.
  map.setPose(p(1), planar(70, 70, 1));
  EXPECT_THAT(idsOf(neighbourhood(map, p(0), {})), ElementsAre(1u, 99u));
}

TEST(Neighbourhood, DoesNotGoThroughWeakEdgesNorThroughUnknownLengths) {
  auto map = chain(straight(2, 0.1));
  for (int i = 0; i < 2; ++i) map.addPlace({});
  join(map, p(0), p(2), EdgeType::kWeak, isotropic(0.01));  // a weak edge, even a certain one (K-E14)
  map::Edge direction{.a = p(0), .b = p(3)};
  direction.T_a_b.T_a_b.translation().x() = 0.1;
  direction.T_a_b.hasScale = false;
  map.addEdge(direction);
  EXPECT_THAT(idsOf(neighbourhood(map, p(0), {})), ElementsAre(1u));
  EXPECT_THAT(neighbourhood(map, p(2), {}), IsEmpty());
}

TEST(Neighbourhood, EndsWhereItDoesNotKnowTheWay) {
  // Ten steps of 3 cm, each uncertain by 10 cm in every direction: 17 cm in all.
  const auto map = chain(straight(11, 0.03), 0.1);
  const NeighbourhoodParams careful{.search_sigma = 0.4};
  EXPECT_THAT(idsOf(neighbourhood(map, p(0), careful)), ElementsAre(1u, 2u, 3u, 4u, 5u));
  EXPECT_EQ(neighbourhood(map, p(0), {.search_sigma = 10}).size(), 10u);
  // Out and back again: known, but beyond the places that are looked through.
  auto there = straight(8, 0.5);
  for (int i = 6; i >= 0; --i) there.push_back(planar(0.5 * i, 0.1, 0));
  const auto loop = chain(there);
  EXPECT_THAT(idsOf(neighbourhood(loop, p(0), {})), ElementsAre(1u));
  EXPECT_THAT(idsOf(neighbourhood(loop, p(0), {.search_distance = 4})), ElementsAre(1u, 14u));
}

/// The more certain of two chains tells where a place is.
TEST(Neighbourhood, BelievesTheMostCertainChain) {
  auto map = chain(straight(3, 0.2));
  map::Edge shortcut{.type = EdgeType::kRecognition, .a = p(2), .b = p(0)};
  shortcut.T_a_b = {planar(-3, 0, 0), isotropic(0.2)};
  map.addEdge(shortcut);
  EXPECT_THAT(idsOf(neighbourhood(map, p(0), {})), ElementsAre(1u, 2u));
}

TEST(Neighbourhood, AgreesWithAllPairs) {
  base::Rng rng(1);
  const double far = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 50; ++round) {
    const auto map = randomMap(rng, 2 + rng.below(30), rng.below(30), 0.2);
    const NeighbourhoodParams params{.distance = rng.uniform(0.5, 2),
                                     .angle = rng.uniform(0.2, 1.5),
                                     .search_distance = far,
                                     .search_sigma = far};
    for (const auto& [from, place] : map.places()) {
      std::vector<std::uint32_t> expected;
      for (const auto& [to, hops] : map.hopDistances(from, 1000)) {
        const Eigen::Isometry3d T = place.T_map_place.inverse() * map.place(to).T_map_place;
        if (to != from && T.translation().norm() <= params.distance &&
            Eigen::AngleAxisd(T.linear()).angle() <= params.angle)
          expected.push_back(to.value);
      }
      EXPECT_EQ(idsOf(neighbourhood(map, from, params)), expected);
    }
  }
}

}  // namespace
}  // namespace engram::upkeep

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/topological_map.h"

#include "engram/base/error.h"
#include "engram/map/graph.h"
#include "engram/posegraph/relaxer.h"
#include "sample_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace engram::map {
namespace {

using engram::testing::planarPose;
using engram::testing::relPose;
using engram::testing::ringMap;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr PlaceId p(std::uint32_t v) { return PlaceId(v); }

template <class F>
std::string messageOf(F&& f) {
  try {
    f();
  } catch (const base::Error& e) {
    return e.what();
  }
  return "no base::Error";
}

Edge validEdge(std::uint32_t a, std::uint32_t b, EdgeType type = EdgeType::kLoop) {
  return {.type = type, .a = p(a), .b = p(b), .T_a_b = relPose(planarPose(1, 2, 0.3)), .correspondences = {}};
}

/// Forgets the features with even ids and adds one new feature.
class ForgetEven : public memory::MemoryModel {
 public:
  memory::PlaceMemory start(const types::Features&) const override { return {}; }
  types::MemoryChange update(memory::PlaceMemory& m, const types::Features& view,
                             std::span<const types::Match>) const override {
    std::vector<int> keep;
    std::vector<memory::FeatureState> states;
    for (std::size_t i = 0; i < m.states.size(); ++i)
      if (m.states[i].id % 2 == 1) {
        keep.push_back(static_cast<int>(i));
        states.push_back(m.states[i]);
      }
    types::MemoryChange change{.added = 1, .pruned = static_cast<int>(m.states.size() - keep.size())};
    m.features = m.features.subset(keep);
    m.features.append(view, 0);
    m.states = states;
    m.states.emplace_back().id = m.nextFeatureId++;
    return change;
  }
};

TEST(TopologicalMap, GivesIdsInOrderAndNeverAgain) {
  auto m = ringMap(4);
  EXPECT_EQ(m.places().size(), 4u);
  EXPECT_EQ(m.addPlace({}), p(4));
  m.removeEdge(EdgeId(3));
  EXPECT_EQ(m.addEdge(validEdge(0, 4)), EdgeId(4));
  EXPECT_EQ(m.addView({.place = p(4)}), ViewId(4));
  m.checkInvariants();
}

TEST(TopologicalMap, RefusesTimesAndPosesWithoutMeaning) {
  auto m = ringMap(3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Place place;
  place.createdStamp = nan;
  EXPECT_THAT(messageOf([&] { m.addPlace(place); }), HasSubstr("its time stamp is not finite"));
  place.createdStamp = 0;
  place.session = -1;
  EXPECT_THAT(messageOf([&] { m.addPlace(place); }), HasSubstr("drive is out of range"));
  EXPECT_THAT(messageOf([&] { m.addView({.place = p(0), .stamp = nan, .label = "x"}); }),
              HasSubstr("view 'x': its time stamp is not finite"));
  EXPECT_THAT(messageOf([&] { m.addPathPoint({.stamp = nan, .anchor = p(0)}); }),
              HasSubstr("its time stamp"));
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().x() = 2e9;
  EXPECT_THAT(messageOf([&] { m.setPose(p(0), far); }), HasSubstr("its pose is more than 1e9 m away"));
  EXPECT_THAT(messageOf([&] { m.addPathPoint({.anchor = p(0), .T_anchor_robot = far}); }),
              HasSubstr("1e9 m"));
  EXPECT_EQ(m.places().size(), 3u);
  m.checkInvariants();
}

TEST(TopologicalMap, RefusesMoreWhenItsNumbersAreUsedUp) {
  MapContent content = ringMap(3).content();
  content.nextPlace = content.nextView = content.nextEdge = kMostIds;
  TopologicalMap m(content);
  EXPECT_THAT(messageOf([&] { m.addPlace({}); }), HasSubstr("start a new one"));
  EXPECT_THAT(messageOf([&] { m.addView({.place = p(0)}); }), HasSubstr("start a new one"));
  EXPECT_THAT(messageOf([&] { m.addEdge(validEdge(0, 1)); }), HasSubstr("start a new one"));
  m.checkInvariants();
  ++content.nextPlace;
  EXPECT_THAT(messageOf([&] { TopologicalMap again(content); }), HasSubstr("used up its numbers"));
}

TEST(TopologicalMap, RefusesBadEdgesByName) {
  auto m = ringMap(3);
  const auto before = m.edges().size();
  EXPECT_THAT(messageOf([&] { m.addEdge(validEdge(1, 1)); }), HasSubstr("itself"));
  EXPECT_THAT(messageOf([&] { m.addEdge(validEdge(0, 9)); }), HasSubstr("no such place"));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Edge e = validEdge(0, 1);
    e.T_a_b.T_a_b.translation().y() = bad;
    EXPECT_THAT(messageOf([&] { m.addEdge(e); }), HasSubstr("place 0 to place 1: its pose is not a finite"));
    e = validEdge(0, 1);
    e.T_a_b.cov(2, 2) = bad;
    EXPECT_THAT(messageOf([&] { m.addEdge(e); }), HasSubstr("not finite"));
  }
  Edge e = validEdge(0, 1);
  e.T_a_b.cov(0, 1) = 1e-3;
  EXPECT_THAT(messageOf([&] { m.addEdge(e); }), HasSubstr("symmetric"));
  e.T_a_b.cov.setZero();
  EXPECT_THAT(messageOf([&] { m.addEdge(e); }), HasSubstr("positive definite"));
  e = validEdge(0, 1);
  e.T_a_b.T_a_b.linear() *= 1.1;
  EXPECT_THAT(messageOf([&] { m.addEdge(e); }), HasSubstr("rigid"));
  EXPECT_EQ(m.edges().size(), before);
  m.checkInvariants();
}

TEST(TopologicalMap, EdgeWithoutScaleNeedsOnlyItsRotation) {
  auto m = ringMap(3);
  Edge e = validEdge(0, 1);
  e.T_a_b.hasScale = false;
  e.T_a_b.cov.topLeftCorner<3, 3>().setZero();
  EXPECT_NO_THROW(m.addEdge(e));
  e.T_a_b.cov(4, 4) = 0;
  EXPECT_THROW(m.addEdge(e), base::Error);
}

TEST(TopologicalMap, RefusesUnknownIdsAndBadPoses) {
  auto m = ringMap(3);
  Eigen::Isometry3d nan = Eigen::Isometry3d::Identity();
  nan.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(m.setPose(p(0), nan), base::Error);
  EXPECT_THROW(m.survey(p(0), nan), base::Error);
  EXPECT_THROW(m.setPose(p(7), planarPose(0, 0, 0)), base::Error);
  EXPECT_THROW(m.addView({.place = p(7)}), base::Error);
  EXPECT_THROW(m.addPathPoint({.anchor = p(7)}), base::Error);
  EXPECT_THROW(m.removeEdge(EdgeId(7)), base::Error);
  EXPECT_THROW(m.neighbours(p(7)), base::Error);
  Place place;
  place.memory.edit().states.resize(2);
  EXPECT_THROW(m.addPlace(place), base::Error);
  // A refused set of poses moves nothing.
  const auto before = m.place(p(0)).T_map_place.matrix().eval();
  EXPECT_THROW(m.setPoses({{p(0), planarPose(5, 5, 0)}, {p(8), planarPose(0, 0, 0)}}), base::Error);
  EXPECT_EQ(m.place(p(0)).T_map_place.matrix(), before);
}

TEST(TopologicalMap, ForgottenFeaturesLeaveTheEdges) {
  auto m = ringMap(4);  // edges carry (0, 1) and (2, 3)
  m.takeChanges();
  base::Rng rng(1);
  const auto change = m.remember(p(1), ForgetEven{}, engram::testing::randomFeatures(rng, 1), {});
  EXPECT_EQ(change.pruned, 10);
  // Place 1 is b of edge 0 (ids 1 and 3 stay) and a of edge 1 (ids 0 and 2 are gone).
  EXPECT_THAT(m.edge(EdgeId(0)).correspondences, ElementsAre(Pair(0, 1), Pair(2, 3)));
  EXPECT_THAT(m.edge(EdgeId(1)).correspondences, IsEmpty());
  m.checkInvariants();
  const auto changes = m.takeChanges();
  EXPECT_THAT(changes.memories, ElementsAre(p(1)));
  EXPECT_THAT(changes.edges, ElementsAre(EdgeId(1)));
  EXPECT_THAT(changes.places, IsEmpty());
  Edge late = validEdge(1, 3);
  late.correspondences = {{0, 1}, {1, 2}, {1, 99}};
  EXPECT_THAT(m.edge(m.addEdge(late)).correspondences, ElementsAre(Pair(1, 2)));
}

TEST(TopologicalMap, KeepsTheFirstRangeOfAFeature) {
  auto m = ringMap(2);
  m.takeChanges();
  const std::size_t n = m.place(p(1)).memory->features.size();
  m.measure(p(1), std::vector<std::pair<int, float>>{{2, 3.5f}, {0, 1.5f}});
  m.measure(p(1), std::vector<std::pair<int, float>>{{2, 9.0f}});
  const auto& ranges = m.place(p(1)).memory->features.ranges;
  ASSERT_EQ(ranges.size(), n);
  EXPECT_EQ(ranges[0], 1.5f);
  EXPECT_EQ(ranges[1], 0.0f);
  EXPECT_EQ(ranges[2], 3.5f);
  EXPECT_THAT(m.takeChanges().memories, ElementsAre(p(1)));
  m.measure(p(1), std::vector<std::pair<int, float>>{{0, 2.0f}});
  EXPECT_TRUE(m.takeChanges().empty());
  m.checkInvariants();
  for (const auto& bad : {std::pair{-1, 1.0f}, {static_cast<int>(n), 1.0f}, {0, 0.0f}, {0, -2.0f}})
    EXPECT_THROW(m.measure(p(0), std::vector<std::pair<int, float>>{bad}), base::Error);
  EXPECT_THROW(m.measure(p(0), std::vector<std::pair<int, float>>{{1, 2.0f}, {-1, 1.0f}}), base::Error);
  EXPECT_TRUE(m.place(p(0)).memory->features.ranges.empty()) << "a bad one changes nothing";
  EXPECT_THROW(m.measure(p(7), {}), base::Error);
}

TEST(TopologicalMap, ListsExactlyWhatChanged) {
  auto m = ringMap(3);
  auto changes = m.takeChanges();
  EXPECT_THAT(changes.places, ElementsAre(p(0), p(1), p(2)));
  EXPECT_EQ(changes.firstNewPathPoint, 0u);
  EXPECT_EQ(changes.pathSize, 3u);
  EXPECT_TRUE(m.takeChanges().empty());
  m.setPose(p(1), m.place(p(1)).T_map_place);  // no change of a bit
  EXPECT_TRUE(m.takeChanges().empty());
  m.setPoses({{p(0), m.place(p(0)).T_map_place}, {p(2), planarPose(1, 1, 1)}});
  m.survey(p(0), planarPose(3, 3, 0));
  const auto added = m.addEdge(validEdge(0, 2));
  m.removeEdge(added);
  m.removeEdge(EdgeId(0));
  m.addPathPoint({.session = 1, .stamp = 4, .anchor = p(2)});
  changes = m.takeChanges();
  EXPECT_THAT(changes.places, ElementsAre(p(0), p(2)));
  EXPECT_THAT(changes.edges, IsEmpty());
  EXPECT_THAT(changes.removedEdges, ElementsAre(EdgeId(0), added));
  EXPECT_EQ(changes.firstNewPathPoint, 3u);
  EXPECT_EQ(m.nextSession(), 2);
}

/// A place goes with all that is its own; the robot's path stays where it was.
TEST(TopologicalMap, RemovedPlaceLeavesNothingBehind) {
  auto m = ringMap(5);
  const auto second = m.addView({.place = p(2), .label = "again"});
  m.addPathPoint({.session = 1, .stamp = 9, .anchor = p(2), .T_anchor_robot = planarPose(0.3, -0.1, 0.4)});
  m.takeChanges();
  m.addPathPoint({.session = 1, .stamp = 10, .anchor = p(2), .T_anchor_robot = planarPose(0.1, 0, 0)});
  EXPECT_THAT(m.viewsOf(p(2)), ElementsAre(ViewId(2), second));
  std::vector<Eigen::Isometry3d> before;
  for (const auto& point : m.path()) before.push_back(m.T_map_robot(point));

  m.removePlace(p(2), p(3));
  m.checkInvariants();
  EXPECT_FALSE(m.places().contains(p(2)));
  EXPECT_FALSE(m.views().contains(ViewId(2)));
  EXPECT_FALSE(m.views().contains(second));
  for (const auto& [id, edge] : m.edges()) EXPECT_TRUE(edge.a != p(2) && edge.b != p(2));
  EXPECT_EQ(m.neighbours(p(3)).size(), 1u);
  ASSERT_EQ(m.path().size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NE(m.path()[i].anchor, p(2));
    EXPECT_TRUE(m.T_map_robot(m.path()[i]).isApprox(before[i], 1e-12)) << i;
  }
  const auto changes = m.takeChanges();
  EXPECT_THAT(changes.removedPlaces, ElementsAre(p(2)));
  EXPECT_THAT(changes.removedViews, ElementsAre(ViewId(2), second));
  EXPECT_THAT(changes.removedEdges, ElementsAre(EdgeId(1), EdgeId(2)));
  EXPECT_THAT(changes.movedPathPoints, ElementsAre(2u, 5u));  // the third was new
  EXPECT_EQ(changes.firstNewPathPoint, 6u);
  EXPECT_THAT(changes.places, IsEmpty());

  // The heir's own end takes all of it along, to the path point that it never had itself.
  m.setPose(p(3), planarPose(1, 2, 3));
  m.removePlace(p(3), p(0));
  EXPECT_THAT(m.takeChanges().movedPathPoints, ElementsAre(2u, 3u, 5u, 6u));
  EXPECT_EQ(m.addPlace({}), p(5));
  m.checkInvariants();
}

TEST(TopologicalMap, RefusesToRemoveWithoutAnHeir) {
  auto m = ringMap(3);
  EXPECT_THAT(messageOf([&] { m.removePlace(p(1), p(1)); }), HasSubstr("its own heir"));
  EXPECT_THAT(messageOf([&] { m.removePlace(p(1), p(7)); }), HasSubstr("no place 7"));
  EXPECT_THAT(messageOf([&] { m.removePlace(p(8), p(1)); }), HasSubstr("no place 8"));
  EXPECT_EQ(m.places().size(), 3u);
  EXPECT_EQ(m.edges().size(), 3u);
}

TEST(TopologicalMap, ListsNothingOfAPlaceThatCameAndWent) {
  auto m = ringMap(3);
  m.takeChanges();
  const auto brief = m.addPlace({});
  m.addView({.place = brief});
  m.addEdge(validEdge(0, brief.value));
  m.removePlace(brief, p(0));
  const auto changes = m.takeChanges();
  EXPECT_THAT(changes.places, IsEmpty());
  EXPECT_THAT(changes.memories, IsEmpty());
  EXPECT_THAT(changes.views, IsEmpty());
  EXPECT_THAT(changes.edges, IsEmpty());
  EXPECT_THAT(changes.removedPlaces, ElementsAre(brief));
}

TEST(TopologicalMap, KeepsTheStandingOfPlaces) {
  auto m = ringMap(3);
  m.takeChanges();
  m.setStanding(p(1), Standing::kConfirmed, std::nullopt);  // as it is
  EXPECT_TRUE(m.takeChanges().empty());
  m.setStanding(p(1), Standing::kProbation, std::nullopt);
  m.setStanding(p(2), Standing::kConfirmed, 12.5);
  EXPECT_THAT(m.takeChanges().places, ElementsAre(p(1), p(2)));
  EXPECT_EQ(m.place(p(1)).standing, Standing::kProbation);
  EXPECT_EQ(m.place(p(2)).matchedStamp, 12.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(messageOf([&] { m.setStanding(p(0), Standing::kConfirmed, nan); }),
              HasSubstr("place 0: the time of its last match"));
}

TEST(TopologicalMap, HopDistancesAreShortestPaths) {
  auto m = ringMap(9);
  const auto hops = m.hopDistances(p(2), 100);
  for (int i = 0; i < 9; ++i) {
    const int d = std::abs(i - 2);
    EXPECT_EQ(hops.at(p(static_cast<std::uint32_t>(i))), std::min(d, 9 - d)) << i;
  }
  EXPECT_EQ(m.hopDistances(p(0), 2).size(), 5u);
  EXPECT_EQ(m.hopDistances(p(0), 0).size(), 1u);
}

TEST(TopologicalMap, HopDistancesAgreeWithFloydWarshall) {
  base::Rng rng(3);
  for (int round = 0; round < 20; ++round) {
    TopologicalMap m;
    const std::uint32_t n = 2 + rng.below(12);
    std::vector<std::vector<int>> d(n, std::vector<int>(n, 1000));
    for (std::uint32_t i = 0; i < n; ++i) {
      m.addPlace({});
      d[i][i] = 0;
    }
    for (std::uint32_t e = 0; e < n + 2; ++e) {
      const auto a = rng.below(n), b = rng.below(n);
      if (a == b) continue;
      const bool weak = rng.uniform() < 0.2;
      m.addEdge(validEdge(a, b, weak ? EdgeType::kWeak : EdgeType::kOdometry));
      if (!weak) d[a][b] = d[b][a] = 1;
    }
    for (std::uint32_t k = 0; k < n; ++k)
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) d[i][j] = std::min(d[i][j], d[i][k] + d[k][j]);
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto hops = m.hopDistances(p(i), 1000);
      for (std::uint32_t j = 0; j < n; ++j)
        EXPECT_EQ(hops.contains(p(j)) ? hops.at(p(j)) : 1000, d[i][j]) << i << " to " << j;
    }
  }
}

TEST(TopologicalMap, WeakEdgesJoinComponentsButAreNotWalked) {
  TopologicalMap m;
  for (int i = 0; i < 5; ++i) m.addPlace({});
  m.addEdge(validEdge(0, 1, EdgeType::kOdometry));
  m.addEdge(validEdge(3, 2, EdgeType::kOdometry));
  EXPECT_THAT(m.components(),
              ElementsAre(ElementsAre(p(0), p(1)), ElementsAre(p(2), p(3)), ElementsAre(p(4))));
  m.addEdge(validEdge(1, 2, EdgeType::kWeak));
  EXPECT_THAT(m.components(), ElementsAre(ElementsAre(p(0), p(1), p(2), p(3)), ElementsAre(p(4))));
  EXPECT_EQ(m.hopDistances(p(0), 10).size(), 2u);
  EXPECT_EQ(m.hopDistances(p(0), 10, true).at(p(3)), 3);
}

TEST(TopologicalMap, PathBendsWithThePlaces) {
  auto m = ringMap(3);
  m.addPathPoint({.session = 0, .stamp = 9, .anchor = p(1), .T_anchor_robot = planarPose(2, 0, 0)});
  m.setPose(p(1), planarPose(5, 1, M_PI / 2));
  const Eigen::Vector3d at = m.T_map_robot(m.path().back()).translation();
  EXPECT_NEAR((at - Eigen::Vector3d(5, 3, 0)).norm(), 0, 1e-12);
}

TEST(TopologicalMap, ForgetsThePathOfOldDrivesAlone) {
  auto m = ringMap(4);
  const auto pathBefore = m.path();
  int last = pathBefore.empty() ? 0 : pathBefore.back().session;
  for (int session = last + 1; session <= last + 3; ++session)
    m.addPathPoint(
        {session, 100.0 * session, p(static_cast<std::uint32_t>(session % 4)), planarPose(1, 0, 0)});
  m.takeChanges();
  m.forgetPath(last + 2);
  ASSERT_EQ(m.path().size(), 2u);
  EXPECT_EQ(m.path().front().session, last + 2);
  EXPECT_EQ(m.places().size(), 4u);
  m.checkInvariants();
  const PlaceId anchor = m.path().front().anchor;
  const Eigen::Isometry3d before = m.T_map_robot(m.path().front());
  m.removePlace(anchor, anchor == p(0) ? p(1) : p(0));  // the numbers of the points are the new ones
  EXPECT_TRUE(m.T_map_robot(m.path().front()).isApprox(before, 1e-9));
  const MapChanges changes = m.takeChanges();
  EXPECT_TRUE(changes.pathForgotten);
  EXPECT_EQ(changes.firstNewPathPoint, 0u);
  EXPECT_EQ(changes.pathSize, 2u);
  m.forgetPath(last + 2);
  EXPECT_TRUE(m.takeChanges().empty()) << "nothing more to forget";
}

/// A ring whose places were pushed about is round again after a relaxation of its graph.
TEST(TopologicalMap, GraphRelaxesBackToTheRing) {
  auto m = ringMap(8);
  const MapContent truth = m.content();
  base::Rng rng(5);
  for (std::uint32_t i = 1; i < 8; ++i)
    m.setPose(p(i),
              m.place(p(i)).T_map_place * planarPose(rng.normal(0, 1), rng.normal(0, 1), rng.normal(0, 0.3)));
  const auto graph = toGraph(m);
  EXPECT_EQ(graph.constraints.size(), 8u);
  EXPECT_FALSE(graph.constraints.front().robust);
  EXPECT_TRUE(graph.constraints.back().robust);
  m.setPoses(posegraph::makeRelaxer({})->relax(graph).poses);
  for (const auto& [id, place] : truth.places)
    EXPECT_TRUE(m.place(id).T_map_place.isApprox(place.T_map_place, 1e-4)) << id.value;
}

TEST(TopologicalMap, DamagedContentIsRefusedByName) {
  const MapContent good = ringMap(3).content();
  const auto why = [&](auto&& damage) {
    MapContent c = good;
    damage(c);
    return messageOf([&] { TopologicalMap{c}; });
  };
  EXPECT_EQ(why([](MapContent&) {}), "no base::Error");
  EXPECT_THAT(why([](MapContent& c) { c.places.erase(p(1)); }), HasSubstr("does not exist"));
  EXPECT_THAT(why([](MapContent& c) { c.nextEdge = 1; }), HasSubstr("edge 1 has a wrong id"));
  EXPECT_THAT(why([](MapContent& c) {
                c.edges.at(EdgeId(0)).correspondences = {{0, 77}};
              }),
              HasSubstr("edge 0 names a feature"));
  EXPECT_THAT(why([](MapContent& c) { c.places.at(p(2)).memory.edit().states[1].id = 0; }),
              HasSubstr("place 2"));
  EXPECT_THAT(why([](MapContent& c) { c.places.at(p(2)).memory.edit().features.keypoints.pop_back(); }),
              HasSubstr("differ in number"));
  EXPECT_THAT(why([](MapContent& c) { c.views.at(ViewId(0)).place = p(50); }), HasSubstr("view 0"));
  EXPECT_THAT(why([](MapContent& c) { c.path[1].anchor = p(50); }), HasSubstr("path point 1"));
}

}  // namespace
}  // namespace engram::map

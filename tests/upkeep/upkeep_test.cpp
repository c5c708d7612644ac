// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/upkeep.h"

#include "engram/base/error.h"
#include "graph_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace engram::upkeep {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

constexpr int kPerPlace = 300;

PlaceId addView(TopologicalMap& map, const Eigen::Isometry3d& T_map_place, double stamp) {
  map::Place place;
  place.T_map_place = T_map_place;
  place.createdStamp = stamp;
  place.memory.features.keypoints.resize(kPerPlace);
  place.memory.features.descriptors = types::Descriptors(types::DescriptorKind::kInt8, 4);
  place.memory.features.descriptors.resize(kPerPlace);
  place.memory.states.resize(kPerPlace);
  for (auto& state : place.memory.states) state.id = place.memory.nextFeatureId++;
  const PlaceId id = map.addPlace(std::move(place));
  map.addView({.place = id, .stamp = stamp});
  map.addPathPoint({.stamp = stamp, .anchor = id});
  return id;
}

map::EdgeId match(TopologicalMap& map, PlaceId a, PlaceId b, int inliers,
                  EdgeType type = EdgeType::kRecognition) {
  map::Edge edge{.type = type, .a = a, .b = b};
  edge.T_a_b = {map.place(a).T_map_place.inverse() * map.place(b).T_map_place, isotropic(0.01)};
  for (int i = 0; i < inliers; ++i)
    edge.correspondences.emplace_back(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i));
  return map.addEdge(edge);
}

Budget budget(int kappa) {
  UpkeepParams params;
  params.max_views = kappa;
  return params.budget(30);
}

TEST(UpkeepParams, TauAsksWhatRecognitionAsks) {
  UpkeepParams params;
  base::validate(params);
  EXPECT_EQ(params.budget(30).rule.tau, 9);
  EXPECT_EQ(params.budget(80).rule.tau, 2.75);
  params.max_closeness = 4;
  EXPECT_EQ(params.budget(80).rule.tau, 4);
  EXPECT_EQ(params.budget(500).rule.tau, 4);
  params.max_closeness = 0;
  EXPECT_THAT(
      [&] { params.budget(500); },
      ThrowsMessage<base::ConfigError>(HasSubstr("view_features = 300 is less than the 500 inliers")));
  params.max_views = 0;
  EXPECT_THROW(base::validate(params), base::ConfigError);
}

TEST(EdgeInliers, IsTheBestOfParallelEdges) {
  TopologicalMap map;
  for (int i = 0; i < 3; ++i) addView(map, planar(i, 0, 0), i);
  match(map, p(0), p(1), 40);
  match(map, p(1), p(0), 70);
  match(map, p(1), p(0), 0);
  const auto inliers = edgeInliers(map);
  EXPECT_EQ(inliers(p(0), p(1)), 70);
  EXPECT_EQ(inliers(p(1), p(0)), 70);
  EXPECT_EQ(inliers(p(0), p(2)), 0);
}

/// Three views at one spot, two of which match; a fourth comes, and one has to go.
TEST(Upkeep, OldestOfTheThickClusterLeavesTheMap) {
  TopologicalMap map;
  for (int i = 0; i < 4; ++i) addView(map, planar(0.1 * i, 0, 0), i);
  addView(map, planar(3, 0, 0), 9);  // elsewhere, hangs on the one that goes
  match(map, p(0), p(1), 0, EdgeType::kOdometry);
  match(map, p(1), p(2), 0, EdgeType::kOdometry);
  match(map, p(1), p(3), 200);
  match(map, p(1), p(4), 29);
  match(map, p(3), p(2), 29);  // one inlier short of a match
  map.addPathPoint({.stamp = 20, .anchor = p(1), .T_anchor_robot = planar(0.05, 0.02, 0.3)});
  const Eigen::Isometry3d before = map.T_map_robot(map.path().back());

  const auto edits = plan(map, p(3), budget(3), edgeInliers(map));
  ASSERT_THAT(edits, ElementsAre(Edit(RemoveView{p(1), {p(3)}})));
  EXPECT_EQ(map.places().size(), 5u) << "a plan changes nothing";
  const Applied done = apply(map, edits);
  map.checkInvariants();
  EXPECT_FALSE(map.places().contains(p(1)));
  EXPECT_FALSE(map.views().contains(map::ViewId(1)));
  EXPECT_TRUE(map.T_map_robot(map.path().back()).isApprox(before, 1e-12));
  ASSERT_EQ(done.removed.size(), 1u);
  EXPECT_EQ(done.removed[0].place, p(1));
  EXPECT_EQ(done.removed[0].heir, p(3));
  EXPECT_THAT(done.removed[0].views, ElementsAre(map::ViewId(1)));
  EXPECT_TRUE(done.removed[0].T_heir_place.isApprox(planar(-0.2, 0, 0), 1e-12));
  // 0 and 4 hung on it alone; 2 has a link to the heir.
  ASSERT_EQ(done.bridges.size(), 2u);
  std::set<PlaceId> ends;
  for (const auto id : done.bridges) {
    EXPECT_EQ(map.edge(id).type, EdgeType::kCompounded);
    ends.insert(map.edge(id).b);
  }
  EXPECT_EQ(ends, (std::set{p(0), p(4)}));
  EXPECT_EQ(map.components().size(), 1u);
}

TEST(Upkeep, StandingIsKeptInTheMap) {
  TopologicalMap map;
  for (int i = 0; i < 3; ++i) addView(map, planar(0.1 * i, 0, 0), i);
  match(map, p(0), p(1), 0, EdgeType::kOdometry);
  match(map, p(1), p(2), 0, EdgeType::kOdometry);
  EXPECT_THAT(plan(map, p(2), budget(3), edgeInliers(map)),
              ElementsAre(Edit(SetStanding{p(2), Standing::kUnmatched, {}})));
  const auto edits = plan(map, p(2), budget(2), edgeInliers(map));
  EXPECT_THAT(edits, ElementsAre(Edit(SetStanding{p(2), Standing::kProbation, {}})));
  apply(map, edits);
  EXPECT_THAT(plan(map, p(2), budget(2), edgeInliers(map)), IsEmpty()) << "nothing has come since";
  // The next one confirms it, and both push out the others.
  addView(map, planar(0.3, 0, 0), 3);
  match(map, p(2), p(3), 100);
  EXPECT_THAT(plan(map, p(3), budget(2), edgeInliers(map)),
              ElementsAre(Edit(RemoveView{p(2), {p(3)}}), Edit(RemoveView{p(0), {}})));
  UpkeepParams params;
  params.touch_on_match = true;
  EXPECT_THAT(plan(map, p(3), params.budget(30), edgeInliers(map)),
              ElementsAre(Edit(SetStanding{p(2), Standing::kConfirmed, 3.0})));
  apply(map, {SetStanding{p(2), Standing::kConfirmed, 3.0}});
  EXPECT_EQ(map.place(p(2)).matchedStamp, 3.0);
}

TEST(Upkeep, RefusesToCutOffTheLastOne) {
  TopologicalMap map;
  addView(map, planar(0, 0, 0), 0);
  addView(map, planar(0, 0, 0), 1);
  const std::vector<Edit> edits{RemoveView{p(0), {}}};
  EXPECT_THAT([&] { apply(map, edits); }, ThrowsMessage<base::Error>(HasSubstr("place 0 cannot be removed")));
  EXPECT_EQ(map.places().size(), 2u);
  EXPECT_THROW(plan(map, p(2), budget(3), edgeInliers(map)), base::Error);
}

/// A robot that lives in a corridor whose walls change: it drives up and down, makes a view every 0.3 m and
/// links it to the views it matches.
class Corridor {
 public:
  Corridor(int kappa, std::uint64_t seed) : kappa_(kappa), rng_(seed) {}

  void drive(int session) {
    for (int step = 0; step <= 20; ++step) {
      // Every section of wall has its own history; some of them never change.
      const int section = step / 3;
      if (section % 3 != 0 && rng_.uniform() < 0.1) ++wall_[section];
      look(0.3 * step + rng_.uniform(-0.1, 0.1), session, section);
    }
    last_ = PlaceId();
    map_.checkInvariants();
  }

  const TopologicalMap& map() const { return map_; }
  std::size_t removed() const { return removed_; }

 private:
  void look(double x, int session, int section) {
    const auto id = addView(map_, planar(x, rng_.uniform(-0.05, 0.05), rng_.normal(0, 0.02)), time_++);
    face_[id] = {section, wall_[section]};
    if (last_.valid()) match(map_, last_, id, 0, EdgeType::kOdometry);
    const bool isLost = !last_.valid() && session > 0;
    if (isLost) join(map_, p(anyPlace()), id, EdgeType::kWeak, isotropic(1000));
    for (const auto& [other, place] : map_.places())
      if (other != id && face_[other] == face_[id] && std::abs(place.T_map_place.translation().x() - x) < 1.0)
        match(map_, other, id, 60);
    last_ = id;
    dropServedWeakEdges();
    keepUp(id);
  }

  std::uint32_t anyPlace() {
    const auto n = rng_.below(static_cast<std::uint32_t>(map_.places().size() - 1));
    return std::next(map_.places().begin(), n)->first.value;
  }

  void dropServedWeakEdges() {
    std::vector<map::EdgeId> served;
    for (const auto& [id, edge] : map_.edges())
      if (edge.type == EdgeType::kWeak && map_.hopDistances(edge.a, 10000).contains(edge.b))
        served.push_back(id);
    for (const auto id : served) map_.removeEdge(id);
  }

  void keepUp(PlaceId id) {
    std::vector<Eigen::Isometry3d> path;
    for (const auto& point : map_.path()) path.push_back(map_.T_map_robot(point));
    const auto edits = plan(map_, id, budget(kappa_), edgeInliers(map_));
    EXPECT_EQ(edits, plan(map_, id, budget(kappa_), edgeInliers(map_)));
    removed_ += apply(map_, edits).removed.size();
    ASSERT_TRUE(map_.places().contains(id)) << "the newest view stays while time goes on";
    EXPECT_EQ(map_.components().size(), 1u);
    for (std::size_t i = 0; i < path.size(); ++i)
      ASSERT_TRUE(map_.T_map_robot(map_.path()[i]).isApprox(path[i], 1e-9));
    expectRoom(id);
  }

  void expectRoom(PlaceId id) const {
    int counted = map_.place(id).standing != Standing::kProbation, onProbation = 1 - counted;
    for (const NearPlace& near : neighbourhood(map_, id, budget(kappa_).near))
      ++(map_.place(near.place).standing == Standing::kProbation ? onProbation : counted);
    EXPECT_LE(counted, kappa_);
    EXPECT_LE(onProbation, 1);
  }

  int kappa_;
  base::Rng rng_;
  double time_ = 0;
  TopologicalMap map_;
  std::map<int, int> wall_;                      // of each section: how often it has changed
  std::map<PlaceId, std::pair<int, int>> face_;  // what a view shows: section, its wall
  PlaceId last_;
  std::size_t removed_ = 0;
};

/// Connected, never more than kappa and one in a neighbourhood, and no larger after forty drives than after
/// twenty.
TEST(UpkeepLaw, ALongLifeStaysBounded) {
  for (const int kappa : {2, 5}) {
    Corridor corridor(kappa, 4);
    std::size_t early = 0, late = 0, edges = 0;
    for (int session = 0; session < 40; ++session) {
      corridor.drive(session);
      auto& most = session < 20 ? early : late;
      most = std::max(most, corridor.map().places().size());
      edges = std::max(edges, corridor.map().edges().size());
    }
    EXPECT_GT(corridor.removed(), 40u * 21u / 2);
    EXPECT_LE(late, early + early / 10);
    // Views within eta / 2 of a spot are in each other's neighbourhood: no more than kappa and one.
    EXPECT_LE(late, static_cast<std::size_t>((kappa + 1) * (6.2 / 0.5 + 1)));
    EXPECT_LE(edges, 15 * late);
  }
}

}  // namespace
}  // namespace engram::upkeep

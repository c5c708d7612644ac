// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surgery.h"

#include "engram/base/error.h"
#include "graph_maps.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace engram::upkeep {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

TopologicalMap unlinked(std::uint32_t places) {
  base::Rng rng(9);
  return scattered(rng, places);
}

std::vector<std::uint32_t> endsOf(const Mending& mending) {
  std::vector<std::uint32_t> ends;
  for (const auto& e : mending.bridges) {
    EXPECT_EQ(e.a, mending.heir);
    ends.push_back(e.b.value);
  }
  return ends;
}

TopologicalMap without(TopologicalMap map, PlaceId gone, const Mending& mending) {
  for (const auto& edge : mending.bridges) map.addEdge(edge);
  map.removePlace(gone, mending.heir);
  map.checkInvariants();
  return map;
}

/// K eq (2) and (3) for a chain (K-12, K-E3), in both directions of the edges, against drawn motions.
TEST(Mend, ChainIsCompoundedAsMonteCarloSays) {
  base::Rng rng(1);
  for (int turned = 0; turned < 4; ++turned) {
    auto map = unlinked(3);
    const auto link = [&](PlaceId other, bool turn) {
      const auto cov = randomCovariance(rng, 0.01);
      turn ? join(map, other, p(0), EdgeType::kOdometry, cov)
           : join(map, p(0), other, EdgeType::kOdometry, cov);
    };
    link(p(1), turned % 2 == 1);
    link(p(2), turned / 2 == 1);
    const Mending mending = mend(map, p(0), {});
    ASSERT_EQ(mending.bridges.size(), 1u);
    const map::Edge& bridge = mending.bridges[0];
    EXPECT_EQ(bridge.type, EdgeType::kCompounded);
    const auto truth = map.place(bridge.a).T_map_place.inverse() * map.place(bridge.b).T_map_place;
    EXPECT_TRUE(bridge.T_a_b.T_a_b.isApprox(truth, 1e-12));

    const auto draw = [&](PlaceId to) {  // T_0_to as the edge may have been in truth
      const map::Edge& e = map.edge(map.neighbours(to)[0].edge);
      const Eigen::LLT<types::Matrix6d> llt(e.T_a_b.cov);
      const Eigen::Isometry3d T = e.T_a_b.T_a_b * posegraph::expSe3(llt.matrixL() * randomMotion(rng, 1, 1));
      return e.a == p(0) ? T : T.inverse();
    };
    constexpr int kDraws = 40000;
    types::Matrix6d cov = types::Matrix6d::Zero();
    for (int i = 0; i < kDraws; ++i) {
      const auto d = posegraph::logSe3(truth.inverse() * draw(bridge.a).inverse() * draw(bridge.b));
      cov += d * d.transpose() / kDraws;
    }
    EXPECT_LT((cov - bridge.T_a_b.cov).norm(), 0.03 * cov.norm()) << turned;
  }
}

/// K-13: 0 goes from the cluster {0, 1, 2}; 3 has another link to it, 4 and 5 have none.
TEST(Mend, ClusterMateTakesOverTheLooseLinks) {
  auto map = unlinked(6);
  const auto link = [&](std::uint32_t a, std::uint32_t b, double sigma) {
    return join(map, p(a), p(b), EdgeType::kRecognition, isotropic(sigma));
  };
  link(0, 1, 0.02);
  link(0, 2, 0.01);
  const auto betweenMates = link(1, 2, 0.02);
  link(0, 3, 0.02);
  link(2, 3, 0.02);
  link(4, 0, 0.02);
  link(0, 5, 0.001);  // better than any mate's
  const std::vector<PlaceId> mates{p(1), p(2)};
  const Mending mending = mend(map, p(0), mates);
  EXPECT_EQ(mending.heir, p(2));
  EXPECT_THAT(endsOf(mending), UnorderedElementsAre(4u, 5u));
  // A mate that hangs together with the heir only over the place that goes needs a link too; who hangs on it
  // does not.
  map.removeEdge(betweenMates);
  link(4, 1, 0.1);
  EXPECT_THAT(endsOf(mend(map, p(0), mates)), UnorderedElementsAre(1u, 5u));
}

TEST(Mend, ClusterOfOneBecomesTheMostCertainTree) {
  auto map = unlinked(6);
  const double sigma[] = {0, 0.3, 0.1, 0.2, 0.4, 0.05};
  for (std::uint32_t i = 1; i < 6; ++i) join(map, p(0), p(i), EdgeType::kOdometry, isotropic(sigma[i]));
  join(map, p(5), p(3), EdgeType::kLoop, isotropic(0.7));
  const Mending mending = mend(map, p(0), {});
  EXPECT_EQ(mending.heir, p(5));
  EXPECT_THAT(endsOf(mending), UnorderedElementsAre(1u, 2u, 4u));
  // The three bridges share what the heir's edge knows.
  const types::RelPose heir{map.place(p(0)).T_map_place.inverse() * map.place(p(5)).T_map_place,
                            3 * isotropic(0.05)};
  for (const auto& e : mending.bridges) {
    const types::RelPose arm{map.place(p(0)).T_map_place.inverse() * map.place(e.b).T_map_place,
                             isotropic(sigma[e.b.value])};
    EXPECT_TRUE(e.T_a_b.cov.isApprox(posegraph::compose(posegraph::inverse(heir), arm).cov, 1e-12));
  }
}

TEST(Mend, EndOfTheLineNeedsNothing) {
  auto map = unlinked(3);
  join(map, p(0), p(1), EdgeType::kOdometry, isotropic(0.1));
  EXPECT_EQ(mend(map, p(0), {}).heir, p(1));
  EXPECT_THAT(mend(map, p(0), {}).bridges, IsEmpty());
  EXPECT_FALSE(mend(map, p(2), {}).heir.valid());
  EXPECT_THROW(mend(map, p(3), {}), base::Error);
  const std::vector<PlaceId> strangers{p(0), p(7)};  // itself, and one that is long gone
  EXPECT_EQ(mend(map, p(0), strangers).heir, p(1));
}

TEST(Mend, WeakLinksStayWeak) {
  auto map = unlinked(4);
  join(map, p(0), p(1), EdgeType::kWeak, isotropic(1000));
  join(map, p(0), p(2), EdgeType::kOdometry, isotropic(0.1));
  join(map, p(0), p(3), EdgeType::kOdometry, isotropic(0.2));
  auto mending = mend(map, p(0), {});
  EXPECT_EQ(mending.heir, p(2));
  ASSERT_THAT(endsOf(mending), ElementsAre(3u, 1u));
  EXPECT_EQ(mending.bridges[0].type, EdgeType::kCompounded);
  EXPECT_EQ(mending.bridges[1].type, EdgeType::kWeak);
  // A weak link does not hold what a normal one held.
  join(map, p(2), p(3), EdgeType::kWeak, isotropic(1000));
  EXPECT_THAT(endsOf(mend(map, p(0), {})), ElementsAre(3u, 1u));
  join(map, p(2), p(1), EdgeType::kWeak, isotropic(1000));
  EXPECT_THAT(endsOf(mend(map, p(0), {})), ElementsAre(3u));
}

TEST(Mend, LengthThatIsNotKnownStaysUnknown) {
  auto map = unlinked(4);
  join(map, p(0), p(2), EdgeType::kOdometry, isotropic(0.2));
  join(map, p(0), p(3), EdgeType::kOdometry, isotropic(0.2));
  map::Edge direction{.a = p(0), .b = p(1)};
  direction.T_a_b = {planar(1, 0, 0.5), isotropic(0.001), false};
  map.addEdge(direction);
  const auto mending = mend(map, p(0), {});
  EXPECT_EQ(mending.heir, p(2)) << "though the edge to 1 is the most certain one";
  ASSERT_THAT(endsOf(mending), ElementsAre(3u, 1u));
  EXPECT_TRUE(mending.bridges[0].T_a_b.hasScale);
  EXPECT_FALSE(mending.bridges[1].T_a_b.hasScale);
  EXPECT_EQ(mending.bridges[1].T_a_b.T_a_b.translation(), Eigen::Vector3d::Zero());
}

/// What all edges together say of small motions of the places, at the poses that they measured.
Eigen::MatrixXd information(const TopologicalMap& map, const std::vector<PlaceId>& order) {
  const auto at = [&](PlaceId id) { return 6 * (std::find(order.begin(), order.end(), id) - order.begin()); };
  const auto n = static_cast<Eigen::Index>(6 * order.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [id, e] : map.edges()) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, n);
    J.middleCols<6>(at(e.a)) = -posegraph::adjoint(e.T_a_b.T_a_b.inverse());
    J.middleCols<6>(at(e.b)).setIdentity();
    sum += J.transpose() * e.T_a_b.cov.inverse() * J;
  }
  return sum;
}

/// K-E4: nothing becomes more certain by forgetting. The exact answer is the marginal of the remaining poses.
TEST(MendLaw, CovarianceNeverShrinks) {
  base::Rng rng(2);
  int exact = 0;
  for (int round = 0; round < 300; ++round) {
    const auto map = randomMap(rng, 3 + rng.below(6), rng.below(8), 0.0);
    const PlaceId gone = p(rng.below(static_cast<std::uint32_t>(map.places().size())));
    std::vector<PlaceId> order, mates;
    for (const auto& [id, place] : map.places()) {
      if (id == gone) continue;
      order.push_back(id);
      if (rng.uniform() < 0.3) mates.push_back(id);
    }
    order.push_back(gone);
    const Eigen::MatrixXd before = information(map, order);
    const auto n = before.rows() - 6;
    const Eigen::MatrixXd marginal =
        before.topLeftCorner(n, n) -
        before.topRightCorner(n, 6) *
            before.bottomRightCorner<6, 6>().llt().solve(before.bottomLeftCorner(6, n));
    order.pop_back();
    const Mending mending = mend(map, gone, mates);
    const Eigen::MatrixXd lost = marginal - information(without(map, gone, mending), order);
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (lost + lost.transpose()))
                             .eigenvalues()
                             .minCoeff();
    EXPECT_GT(least, -1e-9 * before.norm()) << "round " << round;
    if (map.neighbours(gone).size() == 2 && mending.bridges.size() == 1) {
      EXPECT_LT(lost.norm(), 1e-9 * before.norm()) << "a chain loses nothing";
      ++exact;
    }
  }
  EXPECT_GT(exact, 20);
}

/// Groups of places that edges connect, without one of them.
std::set<std::set<PlaceId>> groups(const TopologicalMap& map, bool throughWeak, PlaceId gone) {
  std::set<std::set<PlaceId>> all;
  for (const auto& [id, place] : map.places()) {
    std::set<PlaceId> group;
    for (const auto& [member, hops] : map.hopDistances(id, 1000, throughWeak))
      if (member != gone) group.insert(member);
    if (id != gone) all.insert(group);
  }
  return all;
}

TEST(MendLaw, WhatWasConnectedStaysConnectedAndTheGraphNeverGrows) {
  base::Rng rng(3);
  for (int round = 0; round < 100; ++round) {
    auto map = randomMap(rng, 4 + rng.below(16), rng.below(25), 0.25);
    while (map.places().size() > 1) {
      const auto nth = rng.below(static_cast<std::uint32_t>(map.places().size()));
      const PlaceId gone = std::next(map.places().begin(), nth)->first;
      std::vector<PlaceId> mates;
      for (const auto& [id, place] : map.places())
        if (rng.uniform() < 0.4) mates.push_back(id);
      const auto edges = map.edges().size();
      const auto strong = groups(map, false, gone), all = groups(map, true, gone);
      map = without(std::move(map), gone, mend(map, gone, mates));
      ASSERT_EQ(groups(map, false, PlaceId()), strong);
      ASSERT_EQ(groups(map, true, PlaceId()), all);
      ASSERT_LT(map.edges().size(), edges);
    }
  }
}

}  // namespace
}  // namespace engram::upkeep

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

namespace engram::posegraph {
namespace {

using ::testing::HasSubstr;

TEST(SpanningTree, PrefersTheCertainChainToTheShortOne) {
  Graph g;
  g.poses[p(0)] = Eigen::Isometry3d::Identity();
  // One weak hop says 100 m; two good ones say 2 m.
  g.constraints = {constraint(0, 2, planarPose(100, 0, 0), isotropic(100, 10)),
                   constraint(0, 1, planarPose(1, 0, 0), isotropic(0.1, 0.1)),
                   constraint(2, 1, planarPose(-1, 0, 0), isotropic(0.1, 0.1))};
  addMissingPoses(g);
  EXPECT_NEAR((g.poses.at(p(2)).translation() - Eigen::Vector3d(2, 0, 0)).norm(), 0, 1e-12);
}

TEST(SpanningTree, HasTheSmallestVarianceOfAllChains) {
  base::Rng rng(5);
  for (int round = 0; round < 30; ++round) {
    const std::uint32_t n = 6;
    Graph g;
    g.poses[p(0)] = Eigen::Isometry3d::Identity();
    for (int e = 0; e < 9; ++e) {
      const auto a = rng.below(n), b = rng.below(n);
      if (a != b)
        g.constraints.push_back(
            constraint(a, b, expSe3(randomMotion(rng, 1, 1)), isotropic(rng.uniform(0.1, 2), 0.1)));
    }
    Graph filled = g;
    addMissingPoses(filled);
    // Every simple chain from place 0, by brute force.
    std::map<PlaceId, std::pair<double, Eigen::Isometry3d>> best;
    std::set<PlaceId> onChain;
    const std::function<void(PlaceId, double, const Eigen::Isometry3d&)> walk =
        [&](PlaceId at, double variance, const Eigen::Isometry3d& T) {
          if (!best.contains(at) || variance < best.at(at).first) best[at] = {variance, T};
          onChain.insert(at);
          for (const Constraint& c : g.constraints) {
            const double more = variance + c.T_a_b.cov.trace();
            if (c.a == at && !onChain.contains(c.b)) walk(c.b, more, T * c.T_a_b.T_a_b);
            if (c.b == at && !onChain.contains(c.a)) walk(c.a, more, T * c.T_a_b.T_a_b.inverse());
          }
          onChain.erase(at);
        };
    walk(p(0), 0, Eigen::Isometry3d::Identity());
    for (const auto& [id, chain] : best)
      EXPECT_TRUE(filled.poses.at(id).isApprox(chain.second, 1e-9))
          << "round " << round << " place " << id.value;
  }
}

TEST(SpanningTree, EveryPartGetsAnOriginAndGivenPosesStay) {
  Graph g;
  g.poses[p(4)] = planarPose(7, 8, 0.5);
  g.constraints = {constraint(9, 8, planarPose(1, 0, 0), isotropic(1, 1)),
                   constraint(3, 4, planarPose(1, 0, 0), isotropic(1, 1)),
                   constraint(6, 7, planarPose(2, 0, 0), isotropic(1, 1))};
  addMissingPoses(g);
  EXPECT_EQ(g.poses.size(), 6u);
  EXPECT_TRUE(g.poses.at(p(4)).isApprox(planarPose(7, 8, 0.5)));
  EXPECT_TRUE(g.poses.at(p(3)).isApprox(planarPose(7, 8, 0.5) * planarPose(-1, 0, 0)));
  EXPECT_TRUE(g.poses.at(p(6)).isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_TRUE(g.poses.at(p(8)).isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_TRUE(g.poses.at(p(9)).isApprox(planarPose(-1, 0, 0)));
}

/// K-E1: the constraint takes coordinates in b to a.
TEST(Graph, ResidualOfAKnownPairIsZero) {
  const types::RelPose measured{.T_a_b = planarPose(2, 0, M_PI / 2)};
  EXPECT_NEAR(residual(measured, planarPose(1, 1, M_PI / 2), planarPose(1, 3, M_PI)).norm(), 0, 1e-12);
  EXPECT_GT(residual(measured, planarPose(1, 3, M_PI), planarPose(1, 1, M_PI / 2)).norm(), 1);
}

TEST(Graph, BrokenConstraintsAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto why = [](const Constraint& c) {
    Graph g;
    g.poses = {{p(0), planarPose(0, 0, 0)}, {p(1), planarPose(1, 0, 0)}};
    g.constraints = {c};
    try {
      requireValid(g);
    } catch (const base::Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(why(constraint(0, 1, planarPose(0, 0, 0), isotropic(1, 1))), "");
  EXPECT_THAT(why(constraint(0, 0, planarPose(0, 0, 0), isotropic(1, 1))), HasSubstr("itself"));
  EXPECT_THAT(why(constraint(0, 5, planarPose(0, 0, 0), isotropic(1, 1))), HasSubstr("place 0 to place 5"));
  EXPECT_THAT(why(constraint(0, 1, planarPose(nan, 0, 0), isotropic(1, 1))), HasSubstr("not finite"));
  EXPECT_THAT(why(constraint(0, 1, planarPose(0, 0, 0), isotropic(nan, 1))), HasSubstr("not finite"));
  EXPECT_THAT(why(constraint(0, 1, planarPose(0, 0, 0), isotropic(1, 0))), HasSubstr("positive definite"));
  EXPECT_THAT(why(constraint(0, 1, planarPose(0, 0, 0), -isotropic(1, 1))), HasSubstr("positive definite"));
  types::Matrix6d skewed = isotropic(1, 1);
  skewed(0, 1) = 0.5;
  EXPECT_THAT(why(constraint(0, 1, planarPose(0, 0, 0), skewed)), HasSubstr("symmetric"));
}

}  // namespace
}  // namespace engram::posegraph

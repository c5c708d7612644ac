// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/gating.h"

#include "graph_samples.h"
#include "uncertainty.h"

#include <gtest/gtest.h>

#include <limits>

namespace engram::posegraph {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// A straight drive along x in steps of 1 m.
Graph straight(std::uint32_t n, double metres = 0.05, double radians = 0.01) {
  Graph g;
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    g.constraints.push_back(constraint(i, i + 1, planarPose(1, 0, 0), isotropic(metres, radians)));
  addMissingPoses(g);
  return g;
}

Constraint closure(std::uint32_t a, std::uint32_t b, const Eigen::Isometry3d& T) {
  return constraint(a, b, T, isotropic(0.1, 0.02), true);
}

/// Both searches give, on a chain, the composition of its edges; the tree over a fork too.
TEST(Uncertainty, TreeAndChainComposeTheEdges) {
  base::Rng rng(2);
  Graph g;
  // 0-1-...-9 with a fork 4-10-11-...-14; some edges point backwards.
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    g.constraints.push_back(constraint(a, b, expSe3(randomMotion(rng, 1, 0.4)), randomCovariance(rng, 0.05)));
  };
  for (std::uint32_t i = 0; i < 9; ++i) i % 3 == 1 ? join(i + 1, i) : join(i, i + 1);
  join(10, 4);
  for (std::uint32_t i = 10; i < 14; ++i) join(i, i + 1);
  addMissingPoses(g);
  const TrustedTree tree(g, false);
  ChainFinder finder(g, false);
  const auto edge = [&](std::uint32_t a, std::uint32_t b) {
    for (const Constraint& c : g.constraints) {
      if (c.a == p(a) && c.b == p(b)) return c.T_a_b;
      if (c.a == p(b) && c.b == p(a)) return inverse(c.T_a_b);
    }
    throw base::Error("no such edge");
  };
  for (const auto& path : std::vector<std::vector<std::uint32_t>>{
           {0, 1, 2, 3}, {9, 8, 7, 6, 5, 4, 3}, {13, 12, 11, 10, 4, 5, 6}, {2, 3, 4, 10, 11}, {7, 6}}) {
    types::RelPose expected = edge(path[0], path[1]);
    for (std::size_t i = 1; i + 1 < path.size(); ++i)
      expected = compose(expected, edge(path[i], path[i + 1]));
    const auto found = tree.between(path.front(), path.back());
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->T_a_b.isApprox(expected.T_a_b, 1e-9));
    EXPECT_TRUE(found->cov.isApprox(expected.cov, 1e-6));
    const auto cov = finder.covariance(path.front(), path.back(), kNoLimit);
    ASSERT_TRUE(cov);
    EXPECT_TRUE(cov->isApprox(expected.cov, 1e-6));
    EXPECT_FALSE(finder.covariance(path.front(), path.back(), 1e-6));
  }
}

TEST(Uncertainty, NothingBetweenParts) {
  Graph g = straight(4);
  g.poses[p(9)] = planarPose(0, 0, 0);
  EXPECT_FALSE(TrustedTree(g, true).between(0, 4));
  EXPECT_FALSE(ChainFinder(g, true).covariance(0, 4, kNoLimit));
}

/// n steps without turning noise: the variance along x is n times that of a step.
TEST(Gate, ChiSquareOfAStraightChainInClosedForm) {
  const std::uint32_t n = 26;
  const Graph g = straight(n, 0.05, 1e-9);
  GateParams params;
  const double factor = params.gate_inflation * params.gate_inflation;
  Constraint c = closure(n - 1, 0, planarPose(-25 + 0.4, 0, 0));
  const ClosureDecision d = gateClosure(g, c, params);
  const double variance = factor * 25 * 0.05 * 0.05;
  EXPECT_NEAR(d.sigma, std::sqrt(variance), 1e-6);
  EXPECT_NEAR(d.chi2, 0.4 * 0.4 / (variance + 0.01), 1e-6);
  EXPECT_TRUE(d.accepted);
  c.T_a_b.T_a_b = planarPose(-25 + 4, 0, 0);
  EXPECT_EQ(gateClosure(g, c, params).reason, ClosureReason::kAgainstEstimate);
  EXPECT_EQ(gateClosure(straight(400), closure(399, 0, planarPose(-399, 0, 0)), params).reason,
            ClosureReason::kUnsupported);
}

TEST(Gate, UnusableAndUnconnectedClosures) {
  Graph g = straight(5);
  Constraint c = closure(4, 0, planarPose(-4, 0, 0));
  c.T_a_b.hasScale = false;
  EXPECT_EQ(gateClosure(g, c, {}).reason, ClosureReason::kUnusable);
  EXPECT_EQ(gateClosure(g, closure(4, 77, planarPose(0, 0, 0)), {}).reason, ClosureReason::kUnusable);
  EXPECT_EQ(gateClosure(g, closure(4, 4, planarPose(0, 0, 0)), {}).reason, ClosureReason::kUnusable);
  g.poses[p(9)] = planarPose(0, 0, 0);
  EXPECT_EQ(gateClosure(g, closure(4, 9, planarPose(0, 0, 0)), {}).reason, ClosureReason::kUnsupported);
}

/// With right covariances and no inflation the share that passes is the one asked for.
TEST(Gate, PassesTheShareOfTrueClosuresThatWasAskedFor) {
  base::Rng rng(5);
  GateParams params;
  params.gate_probability = 0.9;
  params.gate_inflation = 1;
  params.gate_lone_sigma = 100;
  for (const bool planar : {true, false}) {
    int passed = 0;
    const int rounds = 1500;
    for (int round = 0; round < rounds; ++round) {
      Graph g;
      const auto noise = [&](double metres, double radians) {
        return expSe3(randomMotion(rng, metres, radians, planar));
      };
      for (std::uint32_t i = 0; i < 10; ++i)
        g.constraints.push_back(
            constraint(i, i + 1, planarPose(1, 0, 0.3) * noise(0.03, 0.01), isotropic(0.03, 0.01)));
      addMissingPoses(g);
      Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
      for (int i = 0; i < 10; ++i) truth = truth * planarPose(1, 0, 0.3);
      passed += gateClosure(g, closure(10, 0, truth.inverse() * noise(0.1, 0.02)), params, planar).accepted;
    }
    EXPECT_NEAR(passed / double(rounds), 0.9, 0.025) << "planar " << planar;
  }
}

TEST(Gate, BoundIsTheQuantile) {
  EXPECT_NEAR(chi2Bound(0.95, 3), 7.815, 0.05);
  EXPECT_NEAR(chi2Bound(0.999, 6), 22.458, 0.2);
}

/// Two runs along the same corridor: closures of the same offset agree, of different ones do not, whatever
/// the drift of the loop between them.
TEST(Pairs, CycleTellsWhatOdometryOfTheLoopCannot) {
  const Graph g = straight(400);
  const Constraint a = closure(300, 10, planarPose(0.2, 0, 0)), b = closure(305, 15, planarPose(0.2, 0, 0)),
                   other = closure(305, 60, planarPose(0, 0, 0));
  EXPECT_EQ(gateClosure(g, a, {}).reason, ClosureReason::kAgainstEstimate);  // 290 m away on this straight
  EXPECT_TRUE(pairConsistency(g, a, b, {}).accepted);
  EXPECT_FALSE(pairConsistency(g, a, other, {}).accepted);
  EXPECT_NEAR(pairConsistency(g, a, b, {}).chi2, pairConsistency(g, b, a, {}).chi2, 1e-6);
  // The same seen from the other end.
  const Constraint back{.a = b.b, .b = b.a, .T_a_b = inverse(b.T_a_b), .robust = true};
  EXPECT_FALSE(pairConsistency(g, a, back, {}).accepted && pairConsistency(g, other, back, {}).accepted);
}

TEST(Consistent, HeaviestSetAsByBruteForce) {
  base::Rng rng(6);
  for (int round = 0; round < 200; ++round) {
    const std::size_t n = 1 + rng.below(11);
    std::vector<double> weights(n);
    for (double& w : weights) w = rng.uniform(0.5, 5);
    std::vector<std::vector<std::size_t>> conflicts(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j)
        if (rng.uniform() < 0.3) {
          conflicts[i].push_back(j);
          conflicts[j].push_back(i);
        }
    const auto weigh = [&](auto in) {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) {
        if (!in(i)) continue;
        sum += weights[i];
        for (const std::size_t j : conflicts[i])
          if (in(j)) return -1.0;
      }
      return sum;
    };
    double best = 0;
    for (std::uint32_t set = 0; set < (1u << n); ++set)
      best = std::max(best, weigh([&](std::size_t i) { return ((set >> i) & 1u) != 0; }));
    const auto kept = heaviestConsistentSet(weights, conflicts);
    EXPECT_NEAR(weigh([&](std::size_t i) { return kept[i] != 0; }), best, 1e-9) << "round " << round;
  }
}

/// Beyond the exact size: no conflict is left, and nothing that could come back is out.
TEST(Consistent, GreedySetIsMaximalAndFreeOfConflicts) {
  base::Rng rng(7);
  const std::size_t n = 300;
  std::vector<double> weights(n);
  for (double& w : weights) w = rng.uniform(0.5, 5);
  std::vector<std::vector<std::size_t>> conflicts(n);
  const auto add = [&](std::size_t i, std::size_t j) {
    conflicts[i].push_back(j);
    conflicts[j].push_back(i);
  };
  for (std::size_t i = 0; i + 1 < n; ++i) add(i, i + 1);
  for (std::size_t i = 0; i + 40 < n; i += 3) add(i, i + 40);
  const auto kept = heaviestConsistentSet(weights, conflicts);
  for (std::size_t i = 0; i < n; ++i) {
    const auto against =
        std::count_if(conflicts[i].begin(), conflicts[i].end(), [&](std::size_t j) { return kept[j] != 0; });
    EXPECT_EQ(kept[i] != 0, against == 0) << i;
  }
}

TEST(Gate, ParametersAreChecked) {
  GateParams params;
  params.gate_probability = 1.5;
  EXPECT_THROW(base::validate(params), base::ConfigError);
}

}  // namespace
}  // namespace engram::posegraph

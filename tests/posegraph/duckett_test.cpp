// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/relaxer.h"
#include "graph_samples.h"

#include <gtest/gtest.h>

namespace engram::posegraph {
namespace {

RelaxerParams duckett(int sweeps = 100000, double tolerance = 1e-12) {
  RelaxerParams params;
  params.relaxer = "duckett";
  params.duckett_max_sweeps = sweeps;
  params.duckett_tolerance = tolerance;
  return params;
}

/// Graph weight of an edge: mean position variance and heading variance, 1 rad as 1 m.
double weightOf(const Constraint& c) {
  return 1 / ((c.T_a_b.cov(0, 0) + c.T_a_b.cov(1, 1)) / 2 + c.T_a_b.cov(5, 5));
}

/// One place between two that stay: eq (6), (7) with variances v_j + v_ji, in closed form.
TEST(Duckett, MiddlePlaceIsTheWeightedMean) {
  Graph g;
  g.poses = {{p(0), planarPose(0, 0, 0)}, {p(1), planarPose(5, 5, 2)}, {p(2), planarPose(4, 0, 0)}};
  g.constraints = {constraint(0, 1, planarPose(1, 0.3, 0.2), isotropic(0.1, 0.1)),
                   constraint(1, 2, planarPose(2, 0, 0), isotropic(0.3, 0.2))};
  const double w0 = 1 / (1e-6 + 1 / weightOf(g.constraints[0])),
               w2 = 1 / (1e-6 + 1 / weightOf(g.constraints[1]));
  const Window window{g, {p(0), p(2)}};
  const Relaxation r = makeRelaxer(duckett())->relax(window);
  EXPECT_EQ(r.ending, Ending::kConverged);
  const Eigen::Isometry3d& T = r.poses.at(p(1));
  EXPECT_NEAR(T.translation().x(), (w0 * 1 + w2 * 2) / (w0 + w2), 1e-9);
  EXPECT_NEAR(T.translation().y(), w0 * 0.3 / (w0 + w2), 1e-9);
  const double yaw = std::atan2(w0 * std::sin(0.2), w0 * std::cos(0.2) + w2);
  EXPECT_NEAR(std::atan2(T(1, 0), T(0, 0)), yaw, 1e-9);
  EXPECT_NEAR(r.variances.at(p(1)), 2 / (w0 + w2), 1e-12);  // eq (4)
}

/// A-E1: the mean of headings on both sides of the half turn is there, not at zero; opposite ones say
/// nothing.
TEST(Duckett, HeadingsAreMeanOnTheCircle) {
  const auto yawWith = [](double first, double second) {
    Graph g;
    g.poses = {{p(0), planarPose(0, 0, 0)}, {p(1), planarPose(0, 0, 0.7)}, {p(2), planarPose(0, 0, 0)}};
    g.constraints = {constraint(0, 1, planarPose(0, 0, first), isotropic(0.1, 0.1)),
                     constraint(2, 1, planarPose(0, 0, second), isotropic(0.1, 0.1))};
    const Eigen::Isometry3d T = makeRelaxer(duckett())->relax(Window{g, {p(0), p(2)}}).poses.at(p(1));
    return std::atan2(T(1, 0), T(0, 0));
  };
  EXPECT_NEAR(std::abs(yawWith(M_PI - 0.2, -M_PI + 0.2)), M_PI, 1e-9);
  EXPECT_NEAR(yawWith(M_PI / 2, -M_PI / 2), 0.7, 1e-9);
}

/// Constraints that agree have one optimum, whatever the weights: that of ceres, and the truth.
TEST(Duckett, ReachesTheOptimumOfCeresOnConsistentGraphs) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Sample s = noisyLoop(seed, 15, true, 1e-12, 1e-12);
    base::Rng rng(seed);
    for (Constraint& c : s.graph.constraints) c.T_a_b.cov = isotropic(rng.uniform(0.05, 0.5), 0.05);
    for (const auto& [id, T] : s.truth)
      s.graph.poses[id] = id == p(0) ? T : T * expSe3(randomMotion(rng, 0.5, 0.3, true));
    const auto ours = makeRelaxer(duckett())->relax(s.graph), ceres = makeRelaxer({})->relax(s.graph);
    EXPECT_EQ(ours.ending, Ending::kConverged);
    EXPECT_LT(ours.chi2After, 1e-9);
    EXPECT_LT(ours.misfit, 1e-6);
    for (const auto& [id, T] : s.truth) {
      EXPECT_LT((ours.poses.at(id).translation() - T.translation()).norm(), 1e-5);
      EXPECT_LT((ours.poses.at(id).translation() - ceres.poses.at(id).translation()).norm(), 1e-4);
    }
  }
}

/// With noise the weighted mean is not the least squares optimum, but close to it.
TEST(Duckett, ImprovesOnOdometryWithNoise) {
  Sample s = noisyLoop(3, 40, true, 0.1, 0.05);
  for (Constraint& c : s.graph.constraints) c.T_a_b.cov = isotropic(0.1, 0.05);
  addMissingPoses(s.graph);
  const auto r = makeRelaxer(duckett())->relax(s.graph), ceres = makeRelaxer({})->relax(s.graph);
  EXPECT_LT(r.chi2After, 0.5 * r.chi2Before);
  EXPECT_LT(r.chi2After, 5 * ceres.chi2After);
}

/// Places on a round of half-metre steps; odometry turns a little too much, so the end misses the start by a
/// few metres. Sweeps and root mean square misfit of the edges: A-E6.
Graph openRound(std::uint32_t n) {
  Graph g;
  g.poses[p(0)] = planarPose(0, 0, 0);
  const double turn = 2 * M_PI / n, drift = 1.045;
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    const Eigen::Isometry3d step = planarPose(0.5, 0, drift * turn);
    g.constraints.push_back(constraint(i, i + 1, step, isotropic(0.1, 0.02)));
    g.poses[p(i + 1)] = g.poses.at(p(i)) * step;
  }
  g.constraints.push_back(constraint(n - 1, 0, planarPose(0.5, 0, turn), isotropic(0.1, 0.02)));
  return g;
}

TEST(Duckett, TwentySweepsAreNotEnoughForTwoHundredPlaces) {
  const Graph g = openRound(202);
  const auto misfit = [&](int sweeps) { return makeRelaxer(duckett(sweeps, 0))->relax(g).misfit; };
  const double m0 =
      residual(g.constraints.back().T_a_b, g.poses.at(p(201)), g.poses.at(p(0))).head<3>().norm() /
      std::sqrt(202.0);
  const double m20 = misfit(20), m200 = misfit(200), m2000 = misfit(2000);
  EXPECT_NEAR(m0, 0.324, 0.1);
  EXPECT_NEAR(m20 / m0, 0.094 / 0.324, 0.1);
  EXPECT_NEAR(m200 / m20, 0.031 / 0.094, 0.25);
  EXPECT_LT(m2000, 0.8 * m200);  // still moving
  EXPECT_EQ(makeRelaxer(duckett(20, 0))->relax(g).ending, Ending::kIterationLimit);
}

/// A-E5, A-E7: edges without length, and sweeps without end.
TEST(Duckett, VariancesStayFiniteAndPositive) {
  Graph g = openRound(60);
  g.constraints[7].T_a_b.T_a_b = planarPose(0, 0, M_PI / 6);
  g.constraints[7].T_a_b.cov = isotropic(1e-9, 1e-9);
  const Relaxation r = makeRelaxer(duckett(5000, 0))->relax(g);
  ASSERT_EQ(r.variances.size(), 60u);
  for (const auto& [id, v] : r.variances) {
    EXPECT_TRUE(std::isfinite(v));
    EXPECT_GT(v, 0);
  }
  for (const auto& [id, T] : r.poses) EXPECT_TRUE(T.matrix().allFinite());
}

TEST(Duckett, StopsAfterTheIterationsOfOneImageInAWindow) {
  const Graph g = openRound(202);
  RelaxerParams params = duckett();
  EXPECT_EQ(makeRelaxer(params)->relax(Window{g, {p(0)}}).iterations, 20);
}

/// Directions have no length: the sweeps pass them over, and what only they join stays.
TEST(Duckett, PassesOverConstraintsWithoutScale) {
  Graph g;
  g.poses = {{p(0), planarPose(0, 0, 0)}, {p(1), planarPose(2, 1, 0.5)}};
  g.constraints = {constraint(0, 1, planarPose(1, 0, 0), isotropic(0.1, 0.1))};
  g.constraints[0].T_a_b.hasScale = false;
  EXPECT_TRUE(makeRelaxer(duckett())->relax(g).poses.at(p(1)).isApprox(g.poses.at(p(1))));
}

}  // namespace
}  // namespace engram::posegraph

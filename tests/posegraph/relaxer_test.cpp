// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/relaxer.h"

#include "graph_samples.h"

#include <gtest/gtest.h>

namespace engram::posegraph {
namespace {

RelaxerParams with(bool planar, const std::string& kernel = "none", const std::string& relaxer = "ceres") {
  RelaxerParams params;
  params.planar = planar;
  params.kernel = kernel;
  params.relaxer = relaxer;
  params.max_iterations = 200;
  return params;
}

double worst(const std::map<PlaceId, Eigen::Isometry3d>& a, const std::map<PlaceId, Eigen::Isometry3d>& b) {
  double worst = 0;
  for (const auto& [id, T] : a) worst = std::max(worst, logSe3(T.inverse() * b.at(id)).norm());
  return worst;
}

/// Dense Gauss-Newton with numeric derivatives; the first pose is fixed.
std::map<PlaceId, Eigen::Isometry3d> bruteForce(const Graph& g) {
  auto poses = g.poses;
  const auto n = static_cast<Eigen::Index>(poses.size()) - 1;
  for (int iteration = 0; iteration < 50; ++iteration) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6 * n, 6 * n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(6 * n);
    for (const Constraint& c : g.constraints) {
      const auto at = [&](const Vector6d& da, const Vector6d& db) {
        return residual(c.T_a_b, poses.at(c.a) * expSe3(da), poses.at(c.b) * expSe3(db));
      };
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 6 * n);
      const double h = 1e-6;
      const Vector6d zero = Vector6d::Zero();
      for (int k = 0; k < 6; ++k) {
        const Vector6d step = h * Vector6d::Unit(k);
        if (c.a.value > 0) J.col(6 * (c.a.value - 1) + k) += (at(step, zero) - at(-step, zero)) / (2 * h);
        if (c.b.value > 0) J.col(6 * (c.b.value - 1) + k) += (at(zero, step) - at(zero, -step)) / (2 * h);
      }
      const types::Matrix6d information = c.T_a_b.cov.inverse();
      H += J.transpose() * information * J;
      b += J.transpose() * information * at(zero, zero);
    }
    const Eigen::VectorXd d = -H.ldlt().solve(b);
    for (Eigen::Index i = 0; i < n; ++i) {
      Eigen::Isometry3d& T = poses.at(p(static_cast<std::uint32_t>(i) + 1));
      T = T * expSe3(d.segment<6>(6 * i));
    }
    if (d.norm() < 1e-11) break;
  }
  return poses;
}

TEST(CeresRelaxer, AgreesWithDenseGaussNewton) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Graph g = noisyLoop(seed, 10, false, 0.05, 0.03).graph;
    addMissingPoses(g);
    const auto truth = bruteForce(g);
    const Relaxation r = makeRelaxer(with(false))->relax(g);
    EXPECT_EQ(r.ending, Ending::kConverged);
    EXPECT_LT(worst(r.poses, truth), 1e-4) << "seed " << seed;
    EXPECT_NEAR(r.chi2After, chi2(g, truth), 1e-6 * (1 + r.chi2After));
    EXPECT_NEAR(r.chi2Before, chi2(g, g.poses), 1e-6 * r.chi2Before);
    EXPECT_LT(r.chi2After, r.chi2Before);
  }
}

/// On a plane with motions that do not mix plane and height, the planar optimum is the spatial one.
TEST(CeresRelaxer, PlanarAgreesWithSpatialOnAPlane) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Graph g = noisyLoop(seed, 12, true, 0.1, 0.05).graph;
    base::Rng rng(seed);
    for (Constraint& c : g.constraints) {
      types::Matrix6d cov = randomCovariance(rng, 0.1);
      for (const int i : {0, 1, 5})
        for (const int j : {2, 3, 4}) cov(i, j) = cov(j, i) = 0;
      c.T_a_b.cov = cov;
    }
    addMissingPoses(g);
    const Relaxation planar = makeRelaxer(with(true))->relax(g), found = makeRelaxer(with(false))->relax(g);
    // On a slope nothing can be left out.
    Graph slope = g;
    const Eigen::Isometry3d T_slope_map = expSe3(randomMotion(rng, 1, 0.3));
    for (auto& [id, T] : slope.poses) T = T_slope_map * T;
    Relaxation spatial = makeRelaxer(with(false))->relax(slope);
    for (auto& [id, T] : spatial.poses) T = T_slope_map.inverse() * T;
    EXPECT_LT(worst(planar.poses, spatial.poses), 1e-4) << "seed " << seed;
    EXPECT_LT(worst(planar.poses, found.poses), 1e-9) << "seed " << seed;
    EXPECT_NEAR(planar.chi2After, spatial.chi2After, 1e-5 * (1 + spatial.chi2After));
  }
}

/// A chain of translations that should close but misses by one metre: each edge takes a share that is
/// proportional to its variance.
TEST(CeresRelaxer, ClosureIsSharedByVariance) {
  const std::vector<double> sigmas{0.1, 0.2, 0.3, 0.1, 0.4};
  const auto n = static_cast<std::uint32_t>(sigmas.size());
  for (const bool planar : {true, false}) {
    Graph g;
    double sum = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      // There and back along x; the last edge leads to the start and is one metre too long.
      const double step = i + 1 < n ? 1.0 : -static_cast<double>(n - 1) + 1.0;
      g.constraints.push_back(constraint(i, (i + 1) % n, planarPose(step, 0, 0), isotropic(sigmas[i], 1e-6)));
      g.poses[p(i)] = planarPose(i, 0, 0);
      sum += sigmas[i] * sigmas[i];
    }
    const Relaxation r = makeRelaxer(with(planar))->relax(g);
    double x = 0;
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      EXPECT_NEAR(r.poses.at(p(i)).translation().x(), x, 1e-6) << "planar " << planar << " place " << i;
      x += 1.0 - sigmas[i] * sigmas[i] / sum;
    }
    EXPECT_NEAR(r.chi2After, 1 / sum, 1e-6);
  }
}

TEST(CeresRelaxer, FirstPlaceOfEveryPartStays) {
  for (const bool planar : {true, false}) {
    Graph g = noisyLoop(9, 6, true, 0.1, 0.05).graph;
    addMissingPoses(g);
    g.poses[p(20)] = planarPose(3, 4, 1);
    g.poses[p(21)] = planarPose(9, 9, 1);
    g.poses[p(30)] = planarPose(1, 2, 3);  // alone
    g.constraints.push_back(constraint(21, 20, planarPose(1, 0, 0), isotropic(0.1, 0.1)));
    const Relaxation r = makeRelaxer(with(planar))->relax(g);
    for (const std::uint32_t fixed : {0u, 20u, 30u})
      EXPECT_TRUE(r.poses.at(p(fixed)).isApprox(g.poses.at(p(fixed)), 1e-12));
    EXPECT_TRUE((r.poses.at(p(21)) * planarPose(1, 0, 0)).isApprox(r.poses.at(p(20)), 1e-6));
  }
}

TEST(CeresRelaxer, PlanarKeepsHeightAndTilt) {
  Graph g = noisyLoop(9, 6, true, 0.1, 0.05).graph;
  addMissingPoses(g);
  const Eigen::AngleAxisd tilt(0.05, Eigen::Vector3d::UnitX());
  for (auto& [id, T] : g.poses) {
    T.linear() = T.linear() * tilt.toRotationMatrix();
    T.translation().z() = 0.1 * id.value;
  }
  const Relaxation r = makeRelaxer(with(true))->relax(g);
  for (const auto& [id, T] : r.poses) {
    EXPECT_NEAR(T.translation().z(), 0.1 * id.value, 1e-12);
    EXPECT_NEAR(T.linear()(2, 2), std::cos(0.05), 1e-9);
  }
}

TEST(CeresRelaxer, SameGraphSamePoses) {
  Graph g = noisyLoop(11, 40, true, 0.1, 0.05).graph;
  addMissingPoses(g);
  const auto a = makeRelaxer(with(true, "cauchy"))->relax(g).poses;
  const Graph copy = g;
  const auto b = makeRelaxer(with(true, "cauchy"))->relax(copy).poses;
  for (const auto& [id, T] : a) EXPECT_EQ(T.matrix(), b.at(id).matrix());
}

/// A false closure pulls the map apart without a kernel and hardly moves it with one.
TEST(CeresRelaxer, KernelsBoundAFalseClosure) {
  Sample s = noisyLoop(2, 30, true, 0.01, 0.005);
  for (Constraint& c : s.graph.constraints) c.T_a_b.cov = isotropic(0.02, 0.01);
  s.graph.constraints.push_back(constraint(20, 3, planarPose(0, 0, 0), isotropic(0.02, 0.01), true));
  addMissingPoses(s.graph);
  const auto error = [&](const std::string& kernel) {
    return worst(makeRelaxer(with(true, kernel))->relax(s.graph).poses, s.truth);
  };
  EXPECT_GT(error("none"), 1.0);
  EXPECT_LT(error("cauchy"), 0.2);
  EXPECT_LT(error("dcs"), 0.1);
  EXPECT_LT(error("huber"), 0.5 * error("none"));
}

/// Three places, directions only, and one edge with a length: the rest follows by triangulation.
TEST(CeresRelaxer, DirectionsTriangulate) {
  for (const bool planar : {true, false}) {
    const std::map<PlaceId, Eigen::Isometry3d> truth{
        {p(0), planarPose(0, 0, 0)}, {p(1), planarPose(4, 0, 0.5)}, {p(2), planarPose(1, 3, -1)}};
    Graph g;
    const auto add = [&](std::uint32_t a, std::uint32_t b, bool scale) {
      Eigen::Isometry3d T = truth.at(p(a)).inverse() * truth.at(p(b));
      if (!scale) T.translation().normalize();
      g.constraints.push_back(constraint(a, b, T, isotropic(0.01, 0.01)));
      g.constraints.back().T_a_b.hasScale = scale;
    };
    add(0, 1, true);
    add(0, 2, false);
    add(1, 2, false);
    g.poses = {{p(0), truth.at(p(0))}, {p(1), planarPose(3, 1, 0.3)}, {p(2), planarPose(3, 3, 0)}};
    const Relaxation r = makeRelaxer(with(planar))->relax(g);
    EXPECT_LT(worst(r.poses, truth), 1e-5) << "planar " << planar;
    EXPECT_LT(r.chi2After, 1e-8);
  }
}

/// The tangent part of the direction is zero for the opposite direction too; that must not be a rest.
TEST(CeresRelaxer, OppositeDirectionIsNotARest) {
  Graph g;
  g.constraints = {constraint(0, 1, planarPose(1, 0, 0), isotropic(0.1, 0.1))};
  g.constraints[0].T_a_b.hasScale = false;
  g.poses = {{p(0), planarPose(0, 0, 0)}, {p(1), planarPose(-2, 0.1, 0)}};
  for (const bool planar : {true, false}) {
    const Relaxation r = makeRelaxer(with(planar))->relax(g);
    EXPECT_GT(r.chi2Before, 100);
    EXPECT_LT(r.chi2After, 1e-6);
    EXPECT_GT(r.poses.at(p(1)).translation().x(), 0);
  }
}

TEST(CeresRelaxer, PureRotationWithoutScaleTurnsOnly) {
  Graph g;
  g.constraints = {constraint(0, 1, planarPose(0, 0, 1), isotropic(0.1, 0.1))};
  g.constraints[0].T_a_b.hasScale = false;
  g.constraints[0].T_a_b.cov.topLeftCorner<3, 3>().setZero();  // geometry may know nothing about it
  g.poses = {{p(0), planarPose(0, 0, 0)}, {p(1), planarPose(2, 1, 0.2)}};
  for (const bool planar : {true, false})
    EXPECT_TRUE(makeRelaxer(with(planar))->relax(g).poses.at(p(1)).isApprox(planarPose(2, 1, 1), 1e-6));
}

TEST(CeresRelaxer, NothingToDoAndLimits) {
  Graph g;
  EXPECT_EQ(makeRelaxer(with(true))->relax(g).ending, Ending::kNothingToDo);
  g.poses[p(0)] = planarPose(0, 0, 0);
  EXPECT_EQ(makeRelaxer(with(true))->relax(g).poses.size(), 1u);
  Graph loop = noisyLoop(2, 30, true, 0.3, 0.2).graph;
  addMissingPoses(loop);
  RelaxerParams one = with(true);
  one.max_iterations = 1;
  const Relaxation r = makeRelaxer(one)->relax(loop);
  EXPECT_EQ(r.ending, Ending::kIterationLimit);
  EXPECT_LE(r.chi2After, r.chi2Before);
}

TEST(Relaxer, RefusesBadGraphsAndParameters) {
  Graph g;
  g.poses = {{p(0), planarPose(0, 0, 0)}};
  g.constraints = {constraint(0, 1, planarPose(1, 0, 0), isotropic(1, 1))};
  for (const char* name : {"ceres", "mrpt_levmarq"})
    EXPECT_THROW(makeRelaxer(with(true, "none", name))->relax(g), base::Error);
  RelaxerParams params;
  params.kernel_width = -1;
  EXPECT_THROW(makeRelaxer(params), base::ConfigError);
  params = {};
  params.relaxer = "toro";
  EXPECT_THROW(makeRelaxer(params), base::ConfigError);
}

/// With equal weights MRPT's solver is right, and is the oracle for ours.
TEST(MrptRelaxer, AgreesWithOursForEqualWeights) {
  for (const bool planar : {true, false}) {
    Graph g = noisyLoop(6, 12, planar, 0.03, 0.01).graph;
    for (Constraint& c : g.constraints) c.T_a_b.cov = types::Matrix6d::Identity();
    addMissingPoses(g);
    const Relaxation ours = makeRelaxer(with(planar))->relax(g);
    const Relaxation theirs = makeRelaxer(with(planar, "none", "mrpt_levmarq"))->relax(g);
    EXPECT_LT(worst(ours.poses, theirs.poses), 2e-3) << "planar " << planar;
    EXPECT_NEAR(ours.chi2After, theirs.chi2After, 0.01 * ours.chi2After) << "planar " << planar;
  }
}

}  // namespace
}  // namespace engram::posegraph

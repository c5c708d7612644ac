// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "refine.h"

#include "scene.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace engram::geometry {
namespace {

using namespace testing_scene;

TwoViewPose disturbed(const TwoViewPose& pose, double angle, bool planar, base::Rng& rng) {
  const Eigen::Vector3d axis = planar ? kUp : randomUnit(rng);
  const Eigen::Vector3d turn = planar ? kUp : randomUnit(rng);
  return {Eigen::AngleAxisd(angle, axis) * pose.R_a_b, Eigen::AngleAxisd(-angle, turn) * pose.t_a_b};
}

/// d of types::RelPose with truth = estimate * exp(d), first order.
Eigen::Matrix<double, 6, 1> errorOf(const TwoViewPose& truth, const TwoViewPose& estimate) {
  Eigen::Matrix<double, 6, 1> d;
  d.head<3>() = estimate.R_a_b.transpose() * (truth.t_a_b - estimate.t_a_b);
  const Eigen::AngleAxisd turn(estimate.R_a_b.transpose() * truth.R_a_b);
  d.tail<3>() = turn.angle() * turn.axis();
  return d;
}

/// d^T cov^+ d over the directions that have variance, of which there must be `rank`.
double nees(const Eigen::Matrix<double, 6, 1>& d, const types::Matrix6d& cov, int rank) {
  const Eigen::SelfAdjointEigenSolver<types::Matrix6d> eigen(cov);
  double sum = 0;
  int positive = 0;
  for (int i = 0; i < 6; ++i) {
    if (eigen.eigenvalues()(i) < 1e-9 * eigen.eigenvalues()(5)) continue;
    ++positive;
    const double along = eigen.eigenvectors().col(i).dot(d);
    sum += along * along / eigen.eigenvalues()(i);
  }
  EXPECT_EQ(positive, rank);
  return sum;
}

TEST(Refine, ReachesTheTruthWithoutNoise) {
  base::Rng rng(1);
  for (const bool planar : {true, false})
    for (int trial = 0; trial < 100; ++trial) {
      const Scene scene = makeScene({.points = 40, .planar = planar}, rng);
      const auto up = planar ? std::optional(kUp) : std::nullopt;
      const auto out = refine(scene.pairs, disturbed(scene.truth, deg(4), planar, rng), up, 30);
      EXPECT_LT(rotationError(out.pose.R_a_b, scene.truth.R_a_b), 1e-7);
      EXPECT_LT(angleBetween(out.pose.t_a_b, scene.truth.t_a_b), 1e-6);
    }
}

TEST(Refine, IsAMinimumOfTheStatedCost) {
  base::Rng rng(2);
  const auto cost = [](const Scene& scene, const TwoViewPose& pose) {
    const Eigen::Matrix3d E = essentialOf(pose);
    double sum = 0;
    for (const auto& [a, b] : scene.pairs)
      sum += std::pow(a.dot(E * b), 2) / ((E * b).squaredNorm() + (E.transpose() * a).squaredNorm());
    return sum;
  };
  for (const bool planar : {true, false}) {
    const Scene scene = makeScene({.points = 60, .sigma = deg(0.3), .planar = planar}, rng);
    const auto up = planar ? std::optional(kUp) : std::nullopt;
    const auto out = refine(scene.pairs, scene.truth, up, 50);
    const double lowest = cost(scene, out.pose);
    EXPECT_LT(lowest, cost(scene, scene.truth));
    for (int i = 0; i < 100; ++i)
      EXPECT_GE(cost(scene, disturbed(out.pose, rng.uniform(-1e-3, 1e-3), planar, rng)), lowest * (1 - 1e-9));
  }
}

TEST(Refine, PlanarStaysPlanar) {
  base::Rng rng(3);
  const Scene scene = makeScene({.points = 60, .sigma = deg(0.5)}, rng);
  const auto out = refine(scene.pairs, disturbed(scene.truth, deg(3), true, rng), kUp);
  EXPECT_NEAR(out.pose.t_a_b.dot(kUp), 0, 1e-12);
  EXPECT_LT((out.pose.R_a_b * kUp - kUp).norm(), 1e-12);
}

TEST(Refine, CovarianceAndSigmaMatchTheErrors) {
  base::Rng rng(4);
  const int trials = 400;
  for (const bool planar : {true, false}) {
    const int rank = planar ? 2 : 5;
    double sum = 0, sigma = 0;
    for (int i = 0; i < trials; ++i) {
      const Scene scene = makeScene({.points = 80, .sigma = deg(0.2), .distance = 1, .planar = planar}, rng);
      const auto out = refine(scene.pairs, scene.truth, planar ? std::optional(kUp) : std::nullopt);
      sum += nees(errorOf(scene.truth, out.pose), out.cov, rank);
      sigma += out.sigma / trials;
    }
    // The mean of `trials` chi-square values: rank +- 4 standard deviations, and 10 % for linearisation.
    EXPECT_NEAR(sum / trials, rank, 4 * std::sqrt(2.0 * rank / trials) + 0.1 * rank) << planar;
    EXPECT_NEAR(sigma, deg(0.2), deg(0.01)) << planar;
  }
}

TEST(FitRotation, FindsItDespiteOutliersWithItsCovariance) {
  base::Rng rng(5);
  const int trials = 300;
  for (const bool planar : {true, false}) {
    const int rank = planar ? 1 : 3;
    double sum = 0;
    for (int i = 0; i < trials; ++i) {
      const SceneOptions options{
          .points = 80, .inlierShare = 0.8, .sigma = deg(0.2), .distance = 0, .planar = planar};
      Scene scene = makeScene(options, rng);
      scene.truth.t_a_b.setZero();
      const auto up = planar ? std::optional(kUp) : std::nullopt;
      const Eigen::Matrix3d start = disturbed(scene.truth, deg(10), planar, rng).R_a_b;
      const auto out = fitRotation(scene.pairs, start, up, deg(1.5));
      EXPECT_LT(rotationError(out.pose.R_a_b, scene.truth.R_a_b), deg(0.2));
      EXPECT_EQ(out.pose.t_a_b, Eigen::Vector3d(0, 0, 0));
      sum += nees(errorOf(scene.truth, out.pose), out.cov, rank);
    }
    EXPECT_NEAR(sum / trials, rank, 4 * std::sqrt(2.0 * rank / trials) + 0.1 * rank) << planar;
  }
}

}  // namespace
}  // namespace engram::geometry

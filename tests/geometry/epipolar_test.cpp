// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "epipolar.h"

#include "scene.h"

#include <gtest/gtest.h>

namespace engram::geometry {
namespace {

using namespace testing_scene;

// The scene's camera has z down; the solver wants z up: turn about x.
BearingPair level(const BearingPair& pair) {
  const Eigen::Matrix3d turn = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return {turn * pair.a, turn * pair.b};
}

TwoViewPose level(const TwoViewPose& pose) {
  const Eigen::Matrix3d turn = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return {turn * pose.R_a_b * turn, turn * pose.t_a_b};
}

TEST(Essential, AnnihilatesEveryStaticPoint) {
  base::Rng rng(1);
  const Scene scene = makeScene({.planar = false}, rng);
  const Eigen::Matrix3d E = essentialOf(scene.truth);
  for (const auto& pair : scene.pairs) {
    EXPECT_NEAR(pair.a.dot(E * pair.b), 0, 1e-12);
    EXPECT_NEAR(angularError(E, pair), 0, 1e-12);
    EXPECT_TRUE(inFront(scene.truth, pair, 1e-6));
    TwoViewPose opposite = scene.truth;
    opposite.t_a_b *= -1;
    EXPECT_FALSE(inFront(opposite, pair, 1e-6));
  }
}

TEST(Essential, AngularErrorIsTheAngleToThePlane) {
  base::Rng rng(2);
  const TwoViewPose still{Eigen::Matrix3d::Identity(), Eigen::Vector3d::UnitX()};
  // Rays orthogonal to the translation: tilting one by an angle tilts it out of the plane by just that.
  for (const double angle : {0.001, 0.1, 1.0}) {
    const BearingPair pair{{0, std::sin(angle), std::cos(angle)}, {0, 0, 1}};
    EXPECT_NEAR(angularError(essentialOf(still), pair), angle, 1e-12);
    EXPECT_NEAR(angularError(5 * essentialOf(still), {pair.b, pair.a}), angle, 1e-12);
  }
}

TEST(InFront, FarPointsPassWithinTheTolerance) {
  const TwoViewPose pose{Eigen::Matrix3d::Identity(), Eigen::Vector3d::UnitX()};
  const BearingPair behind{{0.004, 0, 1}, {-0.004, 0, 1}};  // the rays meet behind the views
  EXPECT_FALSE(inFront(pose, {behind.a.normalized(), -behind.b.normalized()}, 0.01));
  EXPECT_FALSE(inFront(
      pose, {Eigen::Vector3d(-0.1, 0, 1).normalized(), Eigen::Vector3d(0.1, 0, 1).normalized()}, 0.01));
  EXPECT_TRUE(inFront(
      pose, {Eigen::Vector3d(-0.001, 0, 1).normalized(), Eigen::Vector3d(0.001, 0, 1).normalized()}, 0.01));
}

TEST(PlanarSolver, FindsTheTruthFromAnyTwoPairs) {
  base::Rng rng(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Scene scene = makeScene({.points = 2, .distance = rng.uniform(0.1, 1.2)}, rng);
    const TwoViewPose truth = level(scene.truth);
    std::array<PlanarMotion, 2> solutions;
    const int count = solvePlanar(level(scene.pairs[0]), level(scene.pairs[1]), solutions);
    double best = 1e9;
    for (int i = 0; i < count; ++i) {
      const TwoViewPose pose = solutions[static_cast<std::size_t>(i)].pose();
      for (const auto& pair : scene.pairs) EXPECT_NEAR(angularError(essentialOf(pose), level(pair)), 0, 1e-6);
      const double direction =
          std::min(angleBetween(pose.t_a_b, truth.t_a_b), angleBetween(-pose.t_a_b, truth.t_a_b));
      best = std::min(best, rotationError(pose.R_a_b, truth.R_a_b) + direction);
    }
    EXPECT_LT(best, 1e-5) << trial;
  }
}

TEST(PlanarSolver, FindsARotationWithoutParallax) {
  base::Rng rng(6);
  for (const double sigma : {0.0, deg(0.05)})
    for (int trial = 0; trial < 200; ++trial) {
      const Scene scene = makeScene({.points = 2, .sigma = sigma, .distance = 0}, rng);
      const BearingPair p = level(scene.pairs[0]), q = level(scene.pairs[1]);
      const double information =
          std::min({std::abs(p.a.z()), std::abs(q.a.z())}) * p.a.head<2>().norm() * q.a.head<2>().norm() *
          std::abs(std::sin(std::atan2(p.a.y(), p.a.x()) - std::atan2(q.a.y(), q.a.x())));
      if (information < 0.1) continue;
      std::array<PlanarMotion, 2> solutions;
      ASSERT_GE(solvePlanar(p, q, solutions), 1) << trial;
      EXPECT_LT(rotationError(solutions[0].pose().R_a_b, level(scene.truth).R_a_b), 1e-6 + 20 * sigma)
          << trial;
    }
}

TEST(PlanarSolver, RefusesPairsWithoutInformation) {
  std::array<PlanarMotion, 2> solutions;
  const BearingPair horizon{{1, 0, 0}, {0, 1, 0}},
      other{Eigen::Vector3d(1, 2, 1).normalized(), {0, 0.6, 0.8}};
  EXPECT_EQ(solvePlanar(horizon, other, solutions), 0);
  EXPECT_EQ(solvePlanar(other, other, solutions), 0);
}

TEST(EightPoint, RecoversAnyMotion) {
  base::Rng rng(4);
  for (const int points : {8, 9, 60}) {
    for (int trial = 0; trial < 100; ++trial) {
      const Scene scene = makeScene({.points = points, .planar = false}, rng);
      const auto E = solveEssential(scene.pairs);
      ASSERT_TRUE(E);
      int found = 0;
      for (const auto& pose : decompose(*E)) {
        EXPECT_NEAR(pose.R_a_b.determinant(), 1, 1e-9);
        int front = 0;
        for (const auto& pair : scene.pairs) front += inFront(pose, pair, 1e-9);
        if (front < points) continue;
        ++found;
        EXPECT_LT(rotationError(pose.R_a_b, scene.truth.R_a_b), 1e-4);
        EXPECT_LT(angleBetween(pose.t_a_b, scene.truth.t_a_b), 1e-4);
      }
      EXPECT_EQ(found, 1);
    }
  }
}

TEST(EightPoint, RefusesTooFewOrRepeatedPairs) {
  base::Rng rng(5);
  const Scene scene = makeScene({.points = 8, .planar = false}, rng);
  EXPECT_FALSE(solveEssential(std::span(scene.pairs).first(7)));
  const std::vector<BearingPair> same(8, scene.pairs[0]);
  EXPECT_FALSE(solveEssential(same));
}

}  // namespace
}  // namespace engram::geometry

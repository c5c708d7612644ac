// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/geometry/stereo_verify.h"

#include "engram/base/error.h"
#include "scene.h"
#include "stereo_scene.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram::geometry {
namespace {

using namespace testing_scene;

TEST(AlignPoints, AgreesWithUmeyama) {
  base::Rng rng(3);
  for (const int n : {3, 5, 40}) {
    const Eigen::Isometry3d truth = randomMotion(2, 3, rng);
    std::vector<Eigen::Vector3d> a, b;
    Eigen::Matrix3Xd columnsA(3, n), columnsB(3, n);
    for (int i = 0; i < n; ++i) {
      b.push_back(3 * randomUnit(rng));
      a.push_back(truth * b.back() + 0.1 * randomUnit(rng));
      columnsA.col(i) = a.back();
      columnsB.col(i) = b.back();
    }
    const Eigen::Matrix4d oracle = Eigen::umeyama(columnsB, columnsA, false);
    EXPECT_TRUE(alignPoints(a, b).matrix().isApprox(oracle, 1e-9)) << n;
  }
}

TEST(VerifyStereo, FindsTheMotionAmongWrongMatches) {
  base::Rng rng(1);
  for (const double share : {1.0, 0.5, 0.3}) {
    for (int trial = 0; trial < 10; ++trial) {
      const auto scene = makeStereoScene({.points = 200, .inlierShare = share, .sigma = 0.3}, rng);
      const auto result = verifyStereo(scene.matches, kModel, {});
      ASSERT_TRUE(result.ok()) << toString(result.reason) << " at " << share;
      EXPECT_LT((result.T_a_b.T_a_b.translation() - scene.T_a_b.translation()).norm(), 0.03);
      EXPECT_LT(rotationError(result.T_a_b.T_a_b.linear(), scene.T_a_b.linear()), deg(0.3));
      int right = 0;
      for (const int i : result.inliers) right += scene.right[static_cast<std::size_t>(i)];
      EXPECT_GE(right, 0.97 * share * 200);
      EXPECT_LE(static_cast<int>(result.inliers.size()) - right, 4);
      EXPECT_TRUE(result.T_a_b.hasScale);
    }
  }
}

TEST(VerifyStereo, PerfectDataGiveThePerfectMotion) {
  base::Rng rng(2);
  const auto scene = makeStereoScene({.points = 60}, rng);
  const auto result = verifyStereo(scene.matches, kModel, {});
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.inliers.size(), 60U);
  EXPECT_TRUE(result.T_a_b.T_a_b.isApprox(scene.T_a_b, 1e-6));
}

/// K-08: the covariance "out of the refinement" must be that of the estimate. The mean of d^T cov^-1 d over
/// many noisy copies is 6, with a deviation of sqrt(12 / runs).
TEST(RefineStereo, CovarianceIsThatOfMonteCarlo) {
  base::Rng rng(4);
  for (const double distance : {0.05, 0.3, 1.0}) {
    constexpr int kRuns = 400;
    double nees = 0, sigma = 0;
    Eigen::Matrix<double, 6, 6> sample = Eigen::Matrix<double, 6, 6>::Zero(), claimed = sample;
    const auto clean = makeStereoScene({.points = 120, .distance = distance}, rng);
    for (int run = 0; run < kRuns; ++run) {
      const auto noisy = withNoise(clean, 0.3, rng);
      const auto estimate = refineStereo(noisy.matches, kModel, clean.T_a_b);
      const auto d = smallMotion(estimate.T_a_b.T_a_b.inverse() * clean.T_a_b);
      nees += d.dot(estimate.T_a_b.cov.ldlt().solve(d)) / kRuns;
      sigma += estimate.sigma / kRuns;
      sample += d * d.transpose() / kRuns;
      claimed += estimate.T_a_b.cov / kRuns;
    }
    EXPECT_NEAR(nees, 6, 0.7) << distance;
    EXPECT_NEAR(sigma, 0.3, 0.01) << distance;
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(std::sqrt(claimed(i, i) / sample(i, i)), 1, 0.12) << "axis " << i << " at " << distance;
  }
}

/// Without the weights of the depth noise the near points, whose noise the motion magnifies, would count as
/// much as the far ones.
TEST(RefineStereo, IsBetterThanTheClosedForm) {
  base::Rng rng(5);
  double closed = 0, refined = 0;
  for (int run = 0; run < 100; ++run) {
    const auto scene = makeStereoScene({.points = 100, .sigma = 0.3}, rng);
    std::vector<Eigen::Vector3d> a, b;
    for (const auto& match : scene.matches) {
      a.push_back(kModel.toPoint(match.a));
      b.push_back(kModel.toPoint(match.b));
    }
    const Eigen::Isometry3d start = alignPoints(a, b);
    const auto estimate = refineStereo(scene.matches, kModel, start);
    closed += (start.translation() - scene.T_a_b.translation()).squaredNorm();
    refined += (estimate.T_a_b.T_a_b.translation() - scene.T_a_b.translation()).squaredNorm();
  }
  EXPECT_LT(refined, 0.1 * closed);
}

TEST(VerifyStereo, UnrelatedViewsAreRefused) {
  base::Rng rng(6);
  for (int trial = 0; trial < 100; ++trial) {
    const auto scene = makeStereoScene({.points = 300, .inlierShare = 0}, rng);
    const auto result = verifyStereo(scene.matches, kModel, {});
    EXPECT_FALSE(result.ok()) << trial;
    EXPECT_LT(result.inliers.size(), 15U);
  }
}

TEST(VerifyStereo, EveryRefusalHasItsReason) {
  base::Rng rng(7);
  auto scene = makeStereoScene({.points = 29}, rng);
  EXPECT_EQ(verifyStereo(scene.matches, kModel, {}).reason, Reason::kTooFewMatches);
  scene = makeStereoScene({.points = 100, .inlierShare = 0.25, .sigma = 0.2}, rng);
  EXPECT_EQ(verifyStereo(scene.matches, kModel, {}).reason, Reason::kTooFewInliers);
  scene = makeStereoScene({.points = 100, .inlierShare = 0.5, .sigma = 0.2}, rng);
  EXPECT_EQ(verifyStereo(scene.matches, kModel, {.min_inlier_ratio = 0.65}).reason, Reason::kLowRatio);
  EXPECT_EQ(verifyStereo(scene.matches, kModel, {.min_inlier_ratio = 0.4}).reason, Reason::kOk);
}

TEST(VerifyStereo, PointsOnALineDetermineNoRotationAboutIt) {
  base::Rng rng(8);
  StereoScene scene;
  scene.T_a_b = randomMotion(deg(5), 0.2, rng);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d point(-1 + 0.03 * i, 0.2, 3 + 0.01 * i);
    scene.matches.push_back({kModel.project(point), kModel.project(scene.T_a_b.inverse() * point)});
  }
  scene = withNoise(scene, 0.2, rng);
  EXPECT_EQ(verifyStereo(scene.matches, kModel, {}).reason, Reason::kDegenerate);
}

/// V-05 to V-07: five points a sample, a vote by depth, 65 % and ten matches.
TEST(VerifyStereo, VotesByDepthAsAndreasson) {
  base::Rng rng(9);
  const StereoVerifyParams visualScan{
      .min_inliers = 10, .min_inlier_ratio = 0.65, .vote = "depth", .depth_precision = 1, .sample_points = 5};
  for (int trial = 0; trial < 10; ++trial) {
    const auto scene = makeStereoScene({.points = 60, .inlierShare = 0.75, .sigma = 0.3}, rng);
    const auto result = verifyStereo(scene.matches, kModel, visualScan);
    ASSERT_TRUE(result.ok()) << toString(result.reason);
    EXPECT_LT((result.T_a_b.T_a_b.translation() - scene.T_a_b.translation()).norm(), 0.05);
  }
  const auto poor = makeStereoScene({.points = 60, .inlierShare = 0.5, .sigma = 0.3}, rng);
  EXPECT_FALSE(verifyStereo(poor.matches, kModel, visualScan).ok());
}

TEST(VerifyStereo, FeaturesWithoutARangeAreLeftOut) {
  base::Rng rng(10);
  const auto scene = makeStereoScene({.points = 80, .sigma = 0.2}, rng);
  auto [a, b, matches] = toStereoViews(scene);
  const auto whole = verifyStereo(a, b, matches, kModel, {});
  ASSERT_TRUE(whole.ok());
  EXPECT_TRUE(whole.T_a_b.T_a_b.isApprox(verifyStereo(scene.matches, kModel, {}).T_a_b.T_a_b, 1e-3));
  a.ranges[5] = b.ranges[7] = 0;
  const auto part = verifyStereo(a, b, matches, kModel, {});
  EXPECT_THAT(part.inliers, testing::Not(testing::Contains(testing::AnyOf(5, 7))));
  EXPECT_THAT(part.inliers, testing::Contains(79));
  b.ranges.clear();
  EXPECT_THROW(verifyStereo(a, b, matches, kModel, {}), base::Error);
  EXPECT_EQ(verifyStereo(a, b, {}, kModel, {}).reason, Reason::kTooFewMatches);
}

TEST(VerifyStereo, NoDisparityIsAnError) {
  base::Rng rng(11);
  auto scene = makeStereoScene({.points = 40}, rng);
  scene.matches[3].b.disparity = 0;
  EXPECT_THROW(verifyStereo(scene.matches, kModel, {}), base::Error);
}

TEST(VerifyStereo, SameSeedSameResult) {
  base::Rng rng(12);
  const auto scene = makeStereoScene({.points = 200, .inlierShare = 0.3, .sigma = 0.3}, rng);
  const auto one = verifyStereo(scene.matches, kModel, {}), two = verifyStereo(scene.matches, kModel, {});
  EXPECT_EQ(one.inliers, two.inliers);
  EXPECT_EQ(one.T_a_b.T_a_b.matrix(), two.T_a_b.T_a_b.matrix());
}

}  // namespace
}  // namespace engram::geometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/dead_reckoning.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace engram::pipeline {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

Eigen::Isometry3d pose(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0;
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

Vector6d deviation(const Eigen::Isometry3d& T) {
  const Eigen::AngleAxisd r(T.linear());
  Vector6d d;
  d << T.translation(), r.angle() * r.axis();
  return d;
}

/// Sample covariance of `deviations()` over many draws.
types::Matrix6d monteCarlo(int draws, const std::function<Vector6d()>& sample) {
  types::Matrix6d sum = types::Matrix6d::Zero();
  for (int i = 0; i < draws; ++i) {
    const Vector6d d = sample();
    sum += d * d.transpose();
  }
  return sum / draws;
}

TEST(PlanarCovariance, IsDiagonalAndNowhereBelowTheFloor) {
  const types::Matrix6d c = planarCovariance(0.2, 0.001, 0.3, 0.01);
  const Vector6d expected = (Vector6d() << 0.04, 1e-4, 1e-4, 1e-4, 1e-4, 0.09).finished();
  EXPECT_TRUE(c.isApprox(types::Matrix6d(expected.asDiagonal())));
}

OdometryParams noise() {
  OdometryParams p;
  p.sigma_per_metre = 0.02;
  p.sigma_heading_per_metre = 0.01;
  p.sigma_heading_per_radian = 0.05;
  return p;
}

/// Drives straight on for `length` in n steps.
DeadReckoning straight(double length, int n) {
  DeadReckoning r(noise());
  r.move(pose(5, 5, 1));
  r.reset(Eigen::Isometry3d::Identity(), types::Matrix6d::Zero());
  r.markKeyframe();
  for (int i = 1; i <= n; ++i) r.move(pose(5, 5, 1) * pose(length * i / n, 0, 0));
  return r;
}

TEST(DeadReckoning, StraightLineHasTheCovarianceOfBrownianMotion) {
  const double L = 10, s2 = 0.02 * 0.02, h2 = 0.01 * 0.01;
  const types::Matrix6d cov = straight(L, 400).anchorToRobot().cov;
  EXPECT_NEAR(cov(0, 0), s2 * L, 1e-3 * s2 * L);
  EXPECT_NEAR(cov(5, 5), h2 * L, 1e-3 * h2 * L);
  const double lateral = s2 * L + h2 * L * L * L / 3;
  EXPECT_NEAR(cov(1, 1), lateral, 0.01 * lateral);
  EXPECT_NEAR(cov(1, 5), h2 * L * L / 2, 0.01 * h2 * L * L / 2);
}

TEST(DeadReckoning, NoiseDoesNotDependOnTheImageRate) {
  const types::Matrix6d coarse = straight(6, 60).anchorToRobot().cov,
                        fine = straight(6, 600).anchorToRobot().cov;
  for (const int i : {0, 1, 5}) EXPECT_NEAR(coarse(i, i), fine(i, i), 0.03 * fine(i, i)) << i;
}

TEST(DeadReckoning, ArcAgreesWithMonteCarlo) {
  base::Rng rng(3);
  const int n = 20;
  const double d = 0.5, turn = std::numbers::pi / 2 / n;
  const Eigen::Isometry3d step = pose(d, 0, turn);
  DeadReckoning r(noise());
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  r.move(T);
  r.reset(Eigen::Isometry3d::Identity(), types::Matrix6d::Zero());
  for (int i = 0; i < n; ++i) r.move(T = T * step);
  const double yaw = std::sqrt(0.01 * 0.01 * d + 0.05 * 0.05 * turn), along = 0.02 * std::sqrt(d);
  const auto sampled = monteCarlo(20000, [&] {
    Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
    for (int i = 0; i < n; ++i)
      truth = truth * step * pose(rng.normal(0, along), rng.normal(0, along), rng.normal(0, yaw));
    return deviation(T.inverse() * truth);
  });
  for (const int i : {0, 1, 5})
    for (const int k : {0, 1, 5}) {
      const auto& cov = r.anchorToRobot().cov;
      EXPECT_NEAR(sampled(i, k), cov(i, k), 0.06 * std::sqrt(cov(i, i) * cov(k, k))) << i << ' ' << k;
    }
}

TEST(DeadReckoning, CountsDistanceAndRotationSinceTheKeyframe) {
  DeadReckoning r(noise());
  r.move(pose(0, 0, 0));
  r.markKeyframe();
  r.move(pose(3, 4, 0));
  r.move(pose(3, 4, 3.0));
  r.move(pose(3, 4, -3.0));  // on through pi
  r.move(pose(3, 3, -2.9));
  EXPECT_TRUE(r.known());
  EXPECT_NEAR(r.distance(), 6.0, 1e-12);
  EXPECT_NEAR(r.rotation(), 3.0 + (2 * std::numbers::pi - 6.0) + 0.1, 1e-12);
  r.markKeyframe();
  EXPECT_EQ(r.distance(), 0.0);
  EXPECT_EQ(r.rotation(), 0.0);
}

TEST(DeadReckoning, MotionIsUnknownUntilBothEndsHaveOdometry) {
  DeadReckoning r(noise());
  r.move(std::nullopt);
  r.markKeyframe();
  r.reset(Eigen::Isometry3d::Identity(), types::Matrix6d::Zero());
  for (int i = 0; i < 3; ++i) {  // how far it went before the first reading, nobody knows
    r.move(pose(i, 0, 0));
    EXPECT_FALSE(r.known());
    EXPECT_FALSE(r.anchored());
  }
  r.markKeyframe();
  r.move(pose(3, 0, 0));
  EXPECT_TRUE(r.known());
  EXPECT_FALSE(r.anchored());
  r.reset(Eigen::Isometry3d::Identity(), types::Matrix6d::Zero());
  r.move(pose(5, 0, 0));
  EXPECT_TRUE(r.anchored());
  EXPECT_TRUE(r.anchorToRobot().T_a_b.isApprox(pose(2, 0, 0)));
}

TEST(DeadReckoning, GapIsBridgedByWhatTheWheelsCounted) {
  DeadReckoning r(noise());
  r.move(pose(1, 1, 0.5));
  r.markKeyframe();
  r.reset(Eigen::Isometry3d::Identity(), types::Matrix6d::Zero());
  r.move(std::nullopt);
  EXPECT_FALSE(r.known());
  EXPECT_FALSE(r.anchored());
  const Eigen::Isometry3d gap = pose(3, 1, 0.2);
  r.move(pose(1, 1, 0.5) * gap);
  EXPECT_TRUE(r.known());
  EXPECT_TRUE(r.anchored());
  EXPECT_TRUE(r.anchorToRobot().T_a_b.isApprox(gap));
  EXPECT_NEAR(r.distance(), std::hypot(3, 1), 1e-12);
}

TEST(DeadReckoning, AnchorSetWithinAGapIsNotTrusted) {
  DeadReckoning r(noise());
  r.move(pose(0, 0, 0));
  r.move(std::nullopt);
  r.reset(Eigen::Isometry3d::Identity(), types::Matrix6d::Zero());
  r.markKeyframe();
  r.move(pose(4, 0, 0));
  r.move(pose(5, 0, 0));
  EXPECT_FALSE(r.anchored());
  EXPECT_FALSE(r.known());
}

}  // namespace
}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/types/se3.h"

#include "engram/base/rng.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace engram::types {
namespace {

Vector6d someMotion(base::Rng& rng, double metres, double radians) {
  Vector6d v;
  for (int i = 0; i < 3; ++i) v[i] = rng.normal(0, metres);
  for (int i = 3; i < 6; ++i) v[i] = rng.normal(0, radians);
  return v;
}

Matrix6d someCovariance(base::Rng& rng, double sigma) {
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A.data()[i] = rng.normal();
  return symmetric(sigma * sigma * (A * A.transpose() / 6 + 0.2 * Matrix6d::Identity()));
}

RelPose somePose(base::Rng& rng, double sigma = 0.01) {
  return {.T_a_b = expSe3(someMotion(rng, 2, 0.8)), .cov = someCovariance(rng, sigma)};
}

Vector6d draw(const Matrix6d& cov, base::Rng& rng) {
  Vector6d n;
  for (int i = 0; i < 6; ++i) n[i] = rng.normal();
  return cov.llt().matrixL() * n;
}

Matrix6d monteCarlo(int draws, const std::function<Vector6d()>& sample) {
  Matrix6d sum = Matrix6d::Zero();
  for (int i = 0; i < draws; ++i) {
    const Vector6d d = sample();
    sum += d * d.transpose() / draws;
  }
  return sum;
}

/// Largest difference of two covariances in units of the deviations of `expected`.
double worst(const Matrix6d& a, const Matrix6d& expected) {
  const Vector6d s = expected.diagonal().cwiseSqrt().cwiseInverse();
  return (s.asDiagonal() * (a - expected) * s.asDiagonal()).cwiseAbs().maxCoeff();
}

void expectEqual(const RelPose& a, const RelPose& b) {
  EXPECT_LT((a.T_a_b.matrix() - b.T_a_b.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(worst(a.cov, b.cov), 1e-10);
  EXPECT_EQ(a.hasScale, b.hasScale);
}

TEST(Se3, LogarithmInvertsExponential) {
  base::Rng rng(2);
  for (int i = 0; i < 500; ++i) {
    const Vector6d v = someMotion(rng, 3, 1) * std::pow(10.0, -(i % 9));
    if (v.tail<3>().norm() > 3) continue;  // beyond pi it is not unique
    EXPECT_NEAR((logSe3(expSe3(v)) - v).norm(), 0, 1e-9 * std::max(1.0, v.norm())) << v.transpose();
  }
}

/// A quarter turn on a circle of radius 1, in closed form.
TEST(Se3, ExponentialFollowsTheCircle) {
  Vector6d quarter = Vector6d::Zero();
  quarter[0] = quarter[5] = std::numbers::pi / 2;
  Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();
  expected.translation() << 1, 1, 0;
  expected.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(expSe3(quarter).isApprox(expected, 1e-12));
}

TEST(Se3, ThePartsOfTheExponentialAreOneGroup) {
  base::Rng rng(3);
  const Vector6d v = someMotion(rng, 1, 0.5);
  EXPECT_TRUE((expSe3(0.3 * v) * expSe3(0.7 * v)).isApprox(expSe3(v), 1e-12));
  EXPECT_TRUE((expSe3(v) * expSe3(-v)).isApprox(Eigen::Isometry3d::Identity(), 1e-12));
}

TEST(Se3, TheAdjointTakesMotionsToTheOtherFrame) {
  base::Rng rng(4);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Isometry3d T = expSe3(someMotion(rng, 2, 0.9)), U = expSe3(someMotion(rng, 2, 0.9));
    const Vector6d d = someMotion(rng, 0.5, 0.3);
    EXPECT_TRUE((T * expSe3(d)).isApprox(expSe3(adjoint(T) * d) * T, 1e-11));
    EXPECT_TRUE(adjoint(T * U).isApprox(adjoint(T) * adjoint(U), 1e-12));
    EXPECT_TRUE(adjoint(T.inverse()).isApprox(adjoint(T).inverse(), 1e-9));
  }
}

/// Both Jacobians against central differences, through the switch from series to closed form.
TEST(Se3, InverseLeftJacobiansAreThoseOfDifferences) {
  base::Rng rng(5);
  const double h = 1e-6;
  for (const double size : {1e-5, 0.01, 0.049, 0.051, 0.5, 2.0}) {
    Vector6d v = someMotion(rng, 1, 1);
    v.tail<3>() *= size / v.tail<3>().norm();
    const Matrix6d J = inverseLeftJacobian(v);
    const Eigen::Matrix3d J3 = inverseLeftJacobian(Eigen::Vector3d(v.tail<3>()));
    for (int k = 0; k < 6; ++k) {
      const Vector6d d = h * Vector6d::Unit(k);
      const Vector6d slope = (logSe3(expSe3(d) * expSe3(v)) - logSe3(expSe3(-d) * expSe3(v))) / (2 * h);
      EXPECT_LT((slope - J.col(k)).norm(), 1e-7) << size << ' ' << k;
      if (k < 3) continue;
      EXPECT_LT((slope.tail<3>() - J3.col(k - 3)).norm(), 1e-7) << size << ' ' << k;
    }
  }
}

TEST(Se3, CompositionIsAssociative) {
  base::Rng rng(6);
  for (int i = 0; i < 50; ++i) {
    const RelPose a = somePose(rng), b = somePose(rng), c = somePose(rng);
    expectEqual(compose(compose(a, b), c), compose(a, compose(b, c)));
  }
}

/// Covariances of inverses: twice is none, and the inverse of a product is that of its parts turned round.
TEST(Se3, TheInverseIsAnInvolutionThatTurnsProductsRound) {
  base::Rng rng(7);
  for (int i = 0; i < 50; ++i) {
    const RelPose a = somePose(rng), b = somePose(rng);
    expectEqual(inverse(inverse(a)), a);
    expectEqual(inverse(compose(a, b)), compose(inverse(b), inverse(a)));
  }
}

TEST(Se3, NothingIsAddedByStandingStill) {
  base::Rng rng(8);
  const RelPose a = somePose(rng), still{.cov = Matrix6d::Zero()};
  expectEqual(compose(a, still), a);
  expectEqual(compose(still, a), a);
}

TEST(Se3, ComposedCovarianceIsThatOfSamples) {
  base::Rng rng(9);
  const RelPose ab = somePose(rng), bc = somePose(rng, 0.015), ac = compose(ab, bc);
  EXPECT_TRUE(ac.T_a_b.isApprox(ab.T_a_b * bc.T_a_b));
  const Matrix6d sampled = monteCarlo(40000, [&] {
    const auto T = ab.T_a_b * expSe3(draw(ab.cov, rng)) * bc.T_a_b * expSe3(draw(bc.cov, rng));
    return logSe3(ac.T_a_b.inverse() * T);
  });
  EXPECT_LT(worst(sampled, ac.cov), 0.04);
  EXPECT_GT(worst(ab.cov + bc.cov, ac.cov), 0.3) << "the lever arm matters";
}

TEST(Se3, InverseCovarianceIsThatOfSamples) {
  base::Rng rng(10);
  const RelPose ab = somePose(rng), ba = inverse(ab);
  const Matrix6d sampled = monteCarlo(
      40000, [&] { return logSe3(ba.T_a_b.inverse() * (ab.T_a_b * expSe3(draw(ab.cov, rng))).inverse()); });
  EXPECT_LT(worst(sampled, ba.cov), 0.04);
}

/// A camera on a robot: its motion is the robot's, seen from where it is mounted.
TEST(Se3, MotionOfAMountedFrameHasTheCovarianceOfSamples) {
  base::Rng rng(11);
  const Eigen::Isometry3d T_robot_eye = expSe3(someMotion(rng, 0.5, 1));
  const RelPose eye = somePose(rng), robot = seenBy(T_robot_eye, eye);
  EXPECT_TRUE(robot.T_a_b.isApprox(T_robot_eye * eye.T_a_b * T_robot_eye.inverse(), 1e-12));
  const Matrix6d sampled = monteCarlo(40000, [&] {
    const auto T = T_robot_eye * eye.T_a_b * expSe3(draw(eye.cov, rng)) * T_robot_eye.inverse();
    return logSe3(robot.T_a_b.inverse() * T);
  });
  EXPECT_LT(worst(sampled, robot.cov), 0.04);
}

TEST(Se3, CovariancesAreSymmetricToTheLastBit) {
  base::Rng rng(12);
  RelPose chain = somePose(rng);
  for (int i = 0; i < 200; ++i) {
    chain = compose(chain, i % 3 ? somePose(rng) : inverse(somePose(rng)));
    ASSERT_EQ(chain.cov, Matrix6d(chain.cov.transpose())) << i;
    ASSERT_EQ(inverse(chain).cov, Matrix6d(inverse(chain).cov.transpose())) << i;
  }
  EXPECT_EQ(chain.cov.llt().info(), Eigen::Success);
}

TEST(Se3, ScaleIsLostWithEitherPart) {
  RelPose metric, unit;
  unit.hasScale = false;
  EXPECT_TRUE(compose(metric, metric).hasScale);
  EXPECT_FALSE(compose(metric, unit).hasScale);
  EXPECT_FALSE(compose(unit, metric).hasScale);
  EXPECT_FALSE(inverse(unit).hasScale);
  EXPECT_FALSE(seenBy(Eigen::Isometry3d::Identity(), unit).hasScale);
}

TEST(Se3, RigidTakesOutTheRoundingOfLongChains) {
  base::Rng rng(13);
  Eigen::Isometry3d T = expSe3(someMotion(rng, 1, 1));
  T.linear() *= 1 + 1e-7;
  const Eigen::Matrix3d R = rigid(T).linear();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((R - T.linear()).cwiseAbs().maxCoeff(), 2e-7);
  EXPECT_EQ(rigid(T).translation(), T.translation());
}

}  // namespace
}  // namespace engram::types

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Where one camera says that the robot is, against simulated truth.
#include "engram/pipeline/place_fix.h"

#include "engram/pipeline/dead_reckoning.h"
#include "engram/types/se3.h"

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace engram::pipeline {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

const Vector3d kCentre = Vector3d::Zero();  // the camera above the middle of the robot

Isometry3d planar(double x, double y, double heading) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(heading, Vector3d::UnitZ()).toRotationMatrix();
  T.translation() << x, y, 0;
  return T;
}

/// What two views without noise tell.
PlaceMatch seen(const Isometry3d& T_place_robot, const Vector3d& eye = Vector3d::Zero()) {
  PlaceMatch match;
  match.reason = geometry::Reason::kOk;
  match.R_place_view = T_place_robot.linear();
  match.direction_place = (T_place_robot * eye - eye).normalized();
  match.sigmaRotation = 0.02;
  match.sigmaDirection = 0.1;
  return match;
}

types::RelPose expected(const Isometry3d& T, double sigma, double sigmaHeading) {
  return {.T_a_b = T, .cov = planarCovariance(sigma, sigma, sigmaHeading, 1e-3)};
}

TEST(PlaceFix, WithoutALengthTheRobotIsAlongTheDirection) {
  const types::RelPose fix =
      correctedBy(seen(planar(0.3, 0, 0)), expected(planar(0, 0, 0), 0.4, 0.05), kCentre);
  // All directions are equally likely beforehand: the distance is distributed after Rayleigh.
  EXPECT_NEAR(fix.T_a_b.translation().x(), 0.4 * std::sqrt(M_PI / 2), 0.04);
  EXPECT_NEAR(fix.T_a_b.translation().y(), 0, 1e-6);
  EXPECT_NEAR(std::sqrt(fix.cov(0, 0)), 0.4 * std::sqrt(2 - M_PI / 2), 0.04);
  EXPECT_LT(std::sqrt(fix.cov(1, 1)), 0.12);
  EXPECT_LT(std::sqrt(fix.cov(5, 5)), 0.02);
}

TEST(PlaceFix, ACertainLengthAndADirectionAreAPosition) {
  const Isometry3d truth = planar(0.3, 0.4, 0.5);
  types::RelPose odometry = expected(planar(0.5, 0, 0.5), 1, 0.05);  // as far, in another direction
  // In the robot's frame: across the way is open, along it is not.
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(-0.5).toRotationMatrix();
  odometry.cov.topLeftCorner<2, 2>() = turn * Eigen::Vector2d(1e-4, 1).asDiagonal() * turn.transpose();
  const types::RelPose fix = correctedBy(seen(truth), odometry, kCentre);
  EXPECT_NEAR(std::atan2(fix.T_a_b.translation().y(), fix.T_a_b.translation().x()), std::atan2(0.4, 0.3),
              0.1);
}

TEST(PlaceFix, WhatContradictsLeavesWhatWasExpectedLessCertain) {
  const types::RelPose before = expected(planar(0.3, 0, 0), 0.1, 0.02);
  const PlaceMatch match = seen(planar(0.3, 0, 0.5));
  EXPECT_FALSE(agrees(match, before, kCentre));
  EXPECT_TRUE(agrees(seen(planar(0.3, 0, 0.01)), before, kCentre));
  types::RelPose fix = correctedBy(match, before, kCentre);
  EXPECT_TRUE(fix.T_a_b.isApprox(before.T_a_b, 1e-12));
  EXPECT_TRUE(fix.cov.isApprox(4 * before.cov, 1e-12));
  // Said again and again, it is believed in the end.
  for (int i = 0; i < 8; ++i) fix = correctedBy(match, fix, kCentre);
  EXPECT_NEAR(std::atan2(fix.T_a_b(1, 0), fix.T_a_b(0, 0)), 0.5, 0.05);
}

TEST(PlaceFix, AKnownLengthIsAPose) {
  const Vector3d eye(0.2, 0, 0.4);
  const Isometry3d truth = planar(1.2, -0.5, 0.6);
  PlaceMatch match = seen(truth, eye);
  EXPECT_FALSE(measuredBy(match, eye));
  match.length = Length{(truth * eye - eye).norm(), 0.05};
  const auto pose = measuredBy(match, eye);
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->T_a_b.isApprox(truth, 1e-9));
  EXPECT_GT(pose->cov.determinant(), 0);
  // With what was expected, the weights are those of the covariances: between both, nearer the sharper one.
  const types::RelPose vague = expected(planar(1.5, -0.5, 0.6), 0.5, 0.1);
  const types::RelPose fix = correctedBy(match, vague, eye);
  EXPECT_LT((fix.T_a_b.translation() - truth.translation()).norm(), 0.03);
  EXPECT_LT(fix.cov.trace(), pose->cov.trace());
  EXPECT_FALSE(agrees(match, expected(planar(3, -0.5, 0.6), 0.1, 0.1), eye));
}

TEST(PlaceFix, TheCameraMaySitAnywhereOnTheRobot) {
  const Vector3d eye(0.4, 0.1, 0.5);
  // The robot turns on the spot: its camera moves.
  const Isometry3d truth = planar(0, 0, 0.8);
  const types::RelPose fix =
      correctedBy(seen(truth, eye), expected(planar(0.1, -0.1, 0.82), 0.15, 0.05), eye);
  const types::RelPose blind =
      correctedBy(seen(truth, eye), expected(planar(0.1, -0.1, 0.82), 0.15, 0.05), kCentre);
  EXPECT_LT(fix.T_a_b.translation().head<2>().norm(), 0.75 * blind.T_a_b.translation().head<2>().norm());
}

/// The way past a row of places 0.8 m apart, up to 0.24 m to either side.
Isometry3d wayPoint(int i, double phase) {
  return planar(0.4 * i, 0.24 * std::sin(0.5 * i + phase), std::atan(0.3 * std::cos(0.5 * i + phase)));
}

/// With wheels that drift the robot knows where it is better than one spacing tells, and how well.
TEST(PlaceFix, DrivingPastPlacesFixesThePosition) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double squares = 0, nees = 0;
  int count = 0;
  for (int run = 0; run < 40; ++run) {
    const double phase = normal(random);
    Isometry3d truth = wayPoint(0, phase);
    types::RelPose estimate =
        expected(truth * planar(0.2 * normal(random), 0.2 * normal(random), 0), 0.2, 0.02);
    for (int i = 1; i <= 30; ++i) {
      types::RelPose step;
      step.T_a_b = wayPoint(i - 1, phase).inverse() * wayPoint(i, phase);
      const double sigma = 0.03 * std::sqrt(0.4), sigmaHeading = 0.01;
      step.cov = planarCovariance(sigma, sigma, sigmaHeading, 1e-6);
      truth = truth * step.T_a_b *
              planar(sigma * normal(random), sigma * normal(random), sigmaHeading * normal(random));
      estimate = types::compose(estimate, step);
      const Isometry3d T_row_place = planar(0.8 * std::round(truth.translation().x() / 0.8), 0, 0);
      const Isometry3d T_place_robot = T_row_place.inverse() * truth;
      PlaceMatch match = seen(T_place_robot);
      match.R_place_view = match.R_place_view * planar(0, 0, 0.015 * normal(random)).linear();
      match.direction_place =
          planar(0, 0, 0.07 * normal(random)).linear() *
          (T_place_robot.translation() + 0.04 * Vector3d(normal(random), normal(random), 0));
      match.direction_place.normalize();
      types::RelPose before = estimate;
      before.T_a_b = T_row_place.inverse() * estimate.T_a_b;
      const types::RelPose fix = correctedBy(match, before, kCentre);
      estimate = {.T_a_b = T_row_place * fix.T_a_b, .cov = fix.cov};
      const Eigen::SelfAdjointEigenSolver<types::Matrix6d> axes(estimate.cov);
      ASSERT_GT(axes.eigenvalues().minCoeff(), 0);
      if (i < 6) continue;
      const types::Vector6d off = types::logSe3(estimate.T_a_b.inverse() * truth);
      const Vector3d flat(off[0], off[1], off[5]);
      const std::vector<int> plane{0, 1, 5};
      const Eigen::Matrix3d cov = estimate.cov(plane, plane);
      squares += off.head<2>().squaredNorm();
      nees += flat.dot(cov.llt().solve(flat)) / 3;
      ++count;
    }
  }
  ASSERT_GT(count, 900);
  EXPECT_LT(std::sqrt(squares / count), 0.08);
  EXPECT_GT(nees / count, 0.5);
  EXPECT_LT(nees / count, 1.5);
}

}  // namespace
}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/drift.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::evaluation {
namespace {

/// 10 poses a metre along a circle of radius 20 m that climbs.
Trajectory truth(int n) {
  Trajectory out;
  for (int i = 0; i < n; ++i) {
    const double a = 0.1 * i / 20;
    StampedPose pose{0.1 * i, Eigen::Isometry3d::Identity()};
    pose.T_world_body.linear() = Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    pose.T_world_body.translation() = Eigen::Vector3d(20 * std::sin(a), 20 - 20 * std::cos(a), 0.01 * i);
    out.push_back(pose);
  }
  return out;
}

/// Every motion from pose to pose too long by `scale` and turned by `turn` about z.
Trajectory estimate(const Trajectory& truth, double scale, double turn) {
  Trajectory out{truth.front()};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    Eigen::Isometry3d step = truth[i - 1].T_world_body.inverse() * truth[i].T_world_body;
    step.translation() *= scale;
    step = step * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
    out.push_back({truth[i].stamp, out.back().T_world_body * step});
  }
  return out;
}

TEST(Drift, OfAPerfectEstimateIsZero) {
  const auto t = truth(301);
  const auto d = drift(std::vector<Trajectory>{t}, t, std::vector{1.0, 10.0});
  EXPECT_TRUE(d.measured());
  EXPECT_NEAR(d.all.translation, 0, 1e-12);
  EXPECT_NEAR(d.all.rotation, 0, 1e-7);
  EXPECT_NEAR(d.all.length, 30 * std::hypot(1, 0.1), 1e-2);
}

TEST(Drift, ScaleIsAShareOfTheLength) {
  const auto t = truth(301);
  const auto d = drift(std::vector<Trajectory>{estimate(t, 1.03, 0)}, t, std::vector{1.0, 5.0});
  ASSERT_EQ(d.byLength.size(), 2U);
  EXPECT_NEAR(d.byLength[0].translation, 0.03, 1e-4);
  EXPECT_NEAR(d.byLength[1].translation, 0.03, 1e-3);  // the chord of the arc, not the arc
  EXPECT_NEAR(d.byLength[0].rotation, 0, 1e-7);
  EXPECT_EQ(d.all.stretches, d.byLength[0].stretches + d.byLength[1].stretches);
}

TEST(Drift, TurnIsPerMetreAndBendsThePath) {
  const auto t = truth(401);
  const double perPose = 1e-4;  // 1 mrad/m
  const auto d = drift(std::vector<Trajectory>{estimate(t, 1, perPose)}, t, std::vector{2.0, 20.0});
  EXPECT_NEAR(d.byLength[0].rotation, 1e-3, 2e-5);
  EXPECT_NEAR(d.byLength[1].rotation, 1e-3, 2e-5);
  // The end of an arc of length s that bends by k per metre more is k s^2 / 2 aside; a little less on a bend.
  EXPECT_NEAR(d.byLength[1].translation, 1e-3 * 20 / 2, 5e-4);
}

TEST(Drift, NothingCrossesAGap) {
  const auto t = truth(100);  // 10 m
  Trajectory first(t.begin(), t.begin() + 50), second(t.begin() + 50, t.end());
  for (auto& pose : second) pose.T_world_body.translation().x() += 100;  // lost in between
  const auto d = drift(std::vector<Trajectory>{first, second}, t, std::vector{1.0, 4.0, 8.0});
  ASSERT_EQ(d.byLength.size(), 2U);
  EXPECT_NEAR(d.all.translation, 0, 1e-9);
  EXPECT_FALSE(drift(std::vector<Trajectory>{first}, Trajectory{}, std::vector{1.0}).measured());
  EXPECT_FALSE(drift(std::vector<Trajectory>{first}, t, std::vector{100.0}).measured());
}

TEST(FitBody, FindsAConstantTurnOfTheTruth) {
  Trajectory t;  // a flight that goes everywhere
  for (int i = 0; i < 200; ++i) {
    StampedPose pose{0.1 * i, Eigen::Isometry3d::Identity()};
    pose.T_world_body.linear() =
        Eigen::AngleAxisd(0.02 * i, Eigen::Vector3d(1, 0.5, 2).normalized()).toRotationMatrix();
    pose.T_world_body.translation() = Eigen::Vector3d(std::sin(0.05 * i), std::cos(0.08 * i), 0.02 * i);
    t.push_back(pose);
  }
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.09, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const auto turned = turnBody(t, R.transpose());  // as a tracker reports it
  const std::vector<Trajectory> pieces{t};
  EXPECT_GT(drift(pieces, turned, std::vector{1.0}).all.translation, 0.03);
  const auto found = fitBody(pieces, turned);
  ASSERT_TRUE(found);
  EXPECT_LT(Eigen::AngleAxisd(found->transpose() * R).angle(), 1e-6);
  EXPECT_LT(drift(pieces, turnBody(turned, *found), std::vector{1.0}).all.translation, 1e-6);
}

TEST(FitBody, LeavesOpenWhatTheMotionDoesNotTell) {
  const auto t = truth(200);  // always forward
  EXPECT_FALSE(fitBody(std::vector<Trajectory>{t}, t));
  EXPECT_FALSE(fitBody({}, t));
}

}  // namespace
}  // namespace engram::evaluation

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/odometry_gate.h"

#include "engram/sources/rawlog_source.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace engram::sources::test {
namespace {

using ::testing::HasSubstr;

constexpr double kHuge = std::numeric_limits<double>::max();

TEST(JudgePose, LetsPassWhatARobotOnEarthCanHave) {
  for (const Pose2& pose :
       {Pose2{0, 0, 0}, Pose2{-3.5, 7, 3}, Pose2{834000, 9999999, -4000}, Pose2{2e7, -2e7, 1e6}})
    EXPECT_EQ(judgePose(pose), PoseVerdict::kPass) << pose.x;
  EXPECT_EQ(judgeStep({1e4, -1e4, 7}), PoseVerdict::kPass);
}

TEST(JudgePose, RefusesTheRest) {
  for (const double n : {static_cast<double>(NAN), HUGE_VAL, -HUGE_VAL})
    for (const Pose2& pose : {Pose2{n, 0, 0}, Pose2{0, n, 0}, Pose2{0, 0, n}}) {
      EXPECT_EQ(judgePose(pose), PoseVerdict::kNotFinite);
      EXPECT_EQ(judgeStep(pose), PoseVerdict::kNotFinite);
    }
  for (const double far : {kHuge, -kHuge, 1e154, 1e9, -2.1e7})
    for (const Pose2& pose : {Pose2{far, 0, 0}, Pose2{0, far, 0}, Pose2{0, 0, far}}) {
      EXPECT_EQ(judgePose(pose), PoseVerdict::kWild) << far;
      EXPECT_EQ(judgeStep(pose), PoseVerdict::kWild) << far;
    }
  EXPECT_EQ(judgeStep({10001, 0, 0}), PoseVerdict::kWild);
}

/// Every image keeps the pose that it has without the wild readings.
TEST(RawlogSource, WildOdometryIsLeftOutAndSaid) {
  const TempFolder folder;
  Objects objects;
  const std::vector<double> wild{kHuge, -kHuge, 1e154, 1e9};
  for (int i = 0; i < 8; ++i) {
    objects.push_back(odometryObject(kStart + i, i, 0, 0));
    objects.push_back(imageObject(kStart + i + 0.5, picture(i)));
    if (i < 4) objects.push_back(odometryObject(kStart + i + 0.6, wild[static_cast<std::size_t>(i)], 0, 0));
  }
  objects.push_back(odometryObject(kStart + 8, 8, 0, 0));
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 8u);
  for (int i = 0; i < 8; ++i)
    EXPECT_NEAR(frames[static_cast<std::size_t>(i)].T_odom_robot->translation().x(), i + 0.5, 1e-6) << i;
  EXPECT_EQ(source->stats().odometryWild, 4u);
  EXPECT_NEAR(source->stats().pathLength, 8, 1e-9);
  EXPECT_THAT(source->problem(), HasSubstr("4 odometry readings left out: no robot is"));
}

TEST(RawlogSource, WildActionsAreLeftOutAndSaid) {
  const TempFolder folder;
  Objects objects;
  for (int i = 0; i < 6; ++i) {
    objects.push_back(actionObject(kStart + i, i == 2 ? kHuge : i == 4 ? 1e9 : 1, 0, 0));
    objects.push_back(imageObject(kStart + i, picture(i)));
  }
  writeWithMrpt(folder.path("a.rawlog"), objects, true);
  auto source = openRawlog(folder.path("a.rawlog"));
  const auto frames = readFrames(*source);
  ASSERT_EQ(frames.size(), 6u);
  EXPECT_EQ(source->stats().odometryWild, 2u);
  const double driven = (frames[0].T_odom_robot->inverse() * *frames[5].T_odom_robot).translation().norm();
  EXPECT_NEAR(driven, 3, 1e-6) << "the metres of actions 1, 3 and 5";
}

}  // namespace
}  // namespace engram::sources::test

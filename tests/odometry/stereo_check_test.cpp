// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/stereo_check.h"

#include "world_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace engram::odometry {
namespace {

using namespace testing_world;
using testing::AllOf;
using testing::HasSubstr;

/// Round a bend, as a robot at 10 Hz sees it.
const std::vector<Shown>& crooked() {
  static const auto shown = driveThroughOffice(crookedRig(), 24, 0.06, 3);
  return shown;
}
const Rectified& sound() {
  static const Rectified pairs = rectify(crookedRig(), crooked());
  return pairs;
}

StereoHealth check(const std::vector<types::StereoPair>& pairs) {
  StereoCheck check(2);
  for (const auto& pair : pairs) check.add(pair);
  return check.health();
}

TEST(StereoCheck, ASoundCameraPasses) {
  const auto health = check(sound().pairs);
  EXPECT_EQ(health.fault, StereoFault::kNone) << describe(health);
  EXPECT_TRUE(health.ok());
  EXPECT_EQ(describe(health), "");
  EXPECT_EQ(health.pairs, 24);
  EXPECT_GT(health.together.matches, 300);
  EXPECT_GT(health.together.share(), 0.85);
  EXPECT_LT(health.rowError, 1.01);
}

TEST(StereoCheck, UnrectifiedImagesDeclaredRectified) {
  std::vector<types::StereoPair> raw;
  for (const auto& shown : crooked()) raw.push_back(shown.raw);
  const auto health = check(raw);
  EXPECT_EQ(health.fault, StereoFault::kRows);
  EXPECT_GT(health.rowError, 1.5);
  EXPECT_THAT(describe(health), HasSubstr("not rectified"));
}

TEST(StereoCheck, ACalibrationOfAnotherHead) {
  cameras::StereoRig wrong = crookedRig();
  wrong.right.T_robot_cam =
      wrong.right.T_robot_cam * Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitX());  // 1.1 degrees of pitch
  EXPECT_EQ(check(rectify(wrong, crooked()).pairs).fault, StereoFault::kRows);
}

TEST(StereoCheck, SwappedEyes) {
  auto pairs = sound().pairs;
  for (auto& pair : pairs) std::swap(pair.left, pair.right);
  const auto health = check(pairs);
  EXPECT_EQ(health.fault, StereoFault::kSwapped);
  EXPECT_THAT(describe(health), HasSubstr("swapped"));
}

/// Each rectified as if it were the other: their rows do not agree any more.
TEST(StereoCheck, EyesSwappedBeforeRectification) {
  auto shown = crooked();
  for (auto& one : shown) std::swap(one.raw.left, one.raw.right);
  const auto health = check(rectify(crookedRig(), shown).pairs);
  EXPECT_FALSE(health.ok());
  EXPECT_THAT(describe(health), HasSubstr("left and right swapped?"));
}

TEST(StereoCheck, EyesOutOfStepByAFrame) {
  const auto& pairs = sound().pairs;
  std::vector<types::StereoPair> late, early;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    late.push_back({pairs[i].left, pairs[i - 1].right});
    early.push_back({pairs[i - 1].left, pairs[i].right});
  }
  const auto isLate = check(late), isEarly = check(early);
  // A right image that came late is the one of the left image before.
  EXPECT_EQ(isLate.fault, StereoFault::kRightLate);
  EXPECT_EQ(isEarly.fault, StereoFault::kRightEarly);
  EXPECT_THAT(describe(isLate), HasSubstr("out of step"));
}

/// The right images of a calibration that is wrong by `rows` [px]: all of them higher (lower, when negative).
std::vector<types::StereoPair> lifted(std::vector<types::StereoPair> pairs, int rows) {
  for (auto& pair : pairs) {
    cv::Mat moved(pair.right.size(), CV_8U, cv::Scalar(0));
    const int up = std::max(0, rows), down = std::max(0, -rows), left = pair.right.rows - std::abs(rows);
    pair.right.rowRange(up, up + left).copyTo(moved.rowRange(down, down + left));
    pair.right = moved;
  }
  return pairs;
}

std::vector<types::StereoPair> rightOneLate(const std::vector<types::StereoPair>& pairs) {
  std::vector<types::StereoPair> late;
  for (std::size_t i = 1; i < pairs.size(); ++i) late.push_back({pairs[i].left, pairs[i - 1].right});
  return late;
}

TEST(StereoCheck, AnOffsetOfAllRowsIsNotTakenForAnotherTime) {
  for (const int rows : {-6, -3, -2, 2, 3, 6}) {
    const auto health = check(lifted(sound().pairs, rows));
    EXPECT_EQ(health.fault, StereoFault::kRows) << rows << ": " << describe(health);
    EXPECT_NEAR(health.rowOffset, rows, 0.51);
    EXPECT_GT(health.together.share(), 0.8) << rows;
    EXPECT_THAT(describe(health),
                AllOf(HasSubstr("not rectified"), HasSubstr(rows > 0 ? "higher" : "lower")));
  }
}

TEST(StereoCheck, EyesOutOfStepAreFoundUnderAnOffsetOfAllRows) {
  for (const int rows : {-3, 0, 3}) {
    const auto health = check(lifted(rightOneLate(sound().pairs), rows));
    EXPECT_EQ(health.fault, StereoFault::kRightLate) << rows << ": " << describe(health);
    EXPECT_NEAR(health.rowOffset, rows, 0.51);
    EXPECT_EQ(describe(health).find("Besides") != std::string::npos, rows != 0) << describe(health);
  }
}

TEST(StereoCheck, SwappedEyesAreFoundUnderAnOffsetOfAllRows) {
  auto pairs = lifted(sound().pairs, 3);
  for (auto& pair : pairs) std::swap(pair.left, pair.right);
  EXPECT_EQ(check(pairs).fault, StereoFault::kSwapped);
}

/// Less than odometry notices.
TEST(StereoCheck, OneRowIsNoFault) {
  for (const int rows : {-1, 1}) {
    const auto health = check(lifted(sound().pairs, rows));
    EXPECT_TRUE(health.ok()) << rows << ": " << describe(health);
  }
}

TEST(StereoCheck, ACoveredEye) {
  auto pairs = sound().pairs;
  cv::Mat dark(240, 320, CV_8U);
  cv::randn(dark, 8, 2);
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].right = dark;
  const auto right = check(pairs);
  EXPECT_EQ(right.fault, StereoFault::kRightBlank);
  EXPECT_THAT(describe(right), HasSubstr("the right eye shows nothing in"));
  for (auto& pair : pairs) std::swap(pair.left, pair.right);
  EXPECT_EQ(check(pairs).fault, StereoFault::kLeftBlank);
}

/// Covered for a moment is no fault of the camera, and both eyes before a white wall are none either.
TEST(StereoCheck, KnowsWhenItCannotTell) {
  auto pairs = sound().pairs;
  const cv::Mat white(240, 320, CV_8U, cv::Scalar(230));
  for (std::size_t i = 0; i < 6; ++i) pairs[i].right = white;
  const auto moment = check(pairs);
  EXPECT_EQ(moment.fault, StereoFault::kNone);
  EXPECT_GT(moment.rightBlank, 0);
  const auto wall = check(std::vector<types::StereoPair>(10, {white, white}));
  EXPECT_EQ(wall.fault, StereoFault::kUnknown);
  EXPECT_EQ(describe(wall), "");
  EXPECT_EQ(check({}).fault, StereoFault::kUnknown);
}

}  // namespace
}  // namespace engram::odometry

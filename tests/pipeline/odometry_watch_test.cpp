// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/odometry_watch.h"

#include <gmock/gmock.h>

#include <functional>

namespace engram::pipeline::watch_test {
namespace {

using ::testing::HasSubstr;

Eigen::Isometry3d pose(double x, double y, double heading) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, 0);
  return T;
}

/// A circle of 4 m radius at 0.8 m/s, two images a second.
Eigen::Isometry3d onTheCircle(int i) {
  const double angle = 0.1 * i;
  return pose(4 * std::sin(angle), 4 - 4 * std::cos(angle), angle);
}

/// Leaps by image, on that circle as a faulty odometry tells it.
std::vector<int> leapsOf(const std::function<Eigen::Isometry3d(int)>& told, OdometryHealth* health = nullptr,
                         int images = 60) {
  OdometryWatch watch({});
  std::vector<int> leaps;
  for (int i = 0; i < images; ++i)
    if (watch.leaps(told(i), 0.5 * i)) leaps.push_back(i);
  if (health) *health = watch.health();
  return leaps;
}

TEST(OdometryWatch, SoundOdometryLeapsNowhere) {
  OdometryHealth health;
  EXPECT_TRUE(leapsOf(onTheCircle, &health).empty());
  EXPECT_NEAR(health.fastest, 0.8, 0.01);
  EXPECT_EQ(describe(health), "");
}

TEST(OdometryWatch, StartsStopsAndTurnsOnTheSpotAreNoLeaps) {
  const auto told = [](int i) {
    return i < 5 ? pose(0, 0, 0) : i < 9 ? pose(0.5 * (i - 5), 0, 0) : pose(1.5, 0, 0.6 * i);
  };
  EXPECT_TRUE(leapsOf(told).empty());
}

TEST(OdometryWatch, ACounterThatBeginsAnewLeapsOnce) {
  OdometryHealth health;
  const auto told = [](int i) {
    return i < 20 ? onTheCircle(i) : onTheCircle(20).inverse() * onTheCircle(i);
  };
  EXPECT_EQ(leapsOf(told, &health), std::vector<int>{20});
  EXPECT_EQ(faultOf(health), OdometryFault::kLeaps);
  EXPECT_THAT(describe(health), HasSubstr("leapt 1 time"));
}

TEST(OdometryWatch, OneWildReadingLeapsThereAndBack) {
  const auto told = [](int i) { return i == 30 ? pose(1e6, 0, 0) : onTheCircle(i); };
  EXPECT_EQ(leapsOf(told), (std::vector<int>{30, 31}));
}

TEST(OdometryWatch, MillimetresAreTooFast) {
  OdometryHealth health;
  const auto told = [](int i) {
    Eigen::Isometry3d T = onTheCircle(i);
    T.translation() *= 1000;
    return T;
  };
  EXPECT_EQ(leapsOf(told, &health).size(), 59u);
  EXPECT_EQ(faultOf(health), OdometryFault::kTooFast);
  EXPECT_THAT(describe(health), HasSubstr("is it in metres?"));
}

OdometryHealth compared(double ratio, const Eigen::Vector3d& direction) {
  OdometryWatch watch({});
  for (int i = 0; i < 20; ++i) {
    const double turned = i % 4 == 0 ? 0.4 : 0.05;
    watch.compare(pose(1, 0, ratio * turned), pose(0, 0, turned).linear(), direction);
  }
  return watch.health();
}

TEST(OdometryWatch, MeasuresTheRatioOfTheTurning) {
  EXPECT_EQ(describe(compared(1, {1, 0, 0})), "");
  EXPECT_NEAR(compared(0.5, {1, 0, 0}).headingRatio, 0.5, 1e-9);
  EXPECT_THAT(describe(compared(0.5, {1, 0, 0})), HasSubstr("0.50 times as far; is the wheel base right?"));
  EXPECT_THAT(describe(compared(-1, {1, 0, 0})), HasSubstr("turns the other way"));
}

TEST(OdometryWatch, NamesAHeadingThatDoesNotFollow) {
  OdometryWatch watch({});
  for (int i = 0; i < 20; ++i)
    watch.compare(pose(1, 0, i % 2 == 0 ? 1.5 : -1.5), pose(0, 0, 0.3).linear(), Eigen::Vector3d::Zero());
  EXPECT_EQ(faultOf(watch.health()), OdometryFault::kHeading);
  EXPECT_THAT(describe(watch.health()), HasSubstr("100 % is not explained by it; is it in radians?"));
}

TEST(OdometryWatch, NamesAxesThatAreExchanged) {
  EXPECT_EQ(faultOf(compared(1, {0, 1, 0})), OdometryFault::kDirection);
  EXPECT_EQ(compared(1, Eigen::Vector3d::Zero()).directions, 0);
}

TEST(OdometryWatch, WheelsThatStandWhileImagesMoveAreDead) {
  OdometryWatch watch({});
  for (int i = 0; i < 4; ++i) watch.frozen();
  EXPECT_EQ(describe(watch.health()), "");
  watch.frozen();
  EXPECT_THAT(describe(watch.health()), HasSubstr("stood still at 5 images"));
}

}  // namespace
}  // namespace engram::pipeline::watch_test

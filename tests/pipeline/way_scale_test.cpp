// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "way_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace engram::pipeline {
namespace {

/// A round of 100 m, a fix every 1.2 m.
Eigen::Vector3d onTheRound(int i) {
  const double angle = 1.2 * i * 2 * M_PI / 100;
  return {16 * std::cos(angle), 16 * std::sin(angle), 0};
}

/// @param noise of a fix, one sigma [m]; two fixes in a row are at one place and share it
WayScale measured(double mapOverWheels, double noise, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  WayScale scale;
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  for (int i = 0; i < 84; ++i) {
    if (i % 2 == 0) error.head<2>() << noise * normal(random), noise * normal(random);
    scale.add(mapOverWheels * (onTheRound(i) + error), onTheRound(i), 0);
  }
  return scale;
}

TEST(WayScale, KnowsNothingBeforeWaysWereMeasured) {
  WayScale scale;
  EXPECT_FALSE(scale.ratio());
  for (int i = 0; i < 4; ++i) scale.add(onTheRound(i), onTheRound(i), 0);
  EXPECT_FALSE(scale.ratio());
}

TEST(WayScale, MeasuresTheRatioExactlyWithoutNoise) {
  const auto ratio = measured(1.028, 0).ratio();
  ASSERT_TRUE(ratio);
  EXPECT_NEAR(ratio->log, std::log(1.028), 1e-9);
  EXPECT_LT(ratio->sigma, 1e-6);
}

/// Monte Carlo: the mean is right, and the deviation told is that of the trials within a factor of two.
TEST(WayScale, TellsHowCertainItIs) {
  double sum = 0, squares = 0, told = 0;
  const int trials = 200;
  for (int i = 0; i < trials; ++i) {
    const auto ratio = *measured(1.01, 0.1, static_cast<std::uint32_t>(i + 1)).ratio();
    const double error = ratio.log - std::log(1.01);
    sum += error;
    squares += error * error;
    told += ratio.sigma;
  }
  EXPECT_NEAR(sum / trials, 0, 0.001);
  const double deviation = std::sqrt(squares / trials);
  EXPECT_LT(deviation, 0.005);
  EXPECT_GT(told / trials, 0.5 * deviation);
  EXPECT_LT(told / trials, 2 * deviation);
}

TEST(WayScale, NoWayLeadsOverALeap) {
  WayScale scale;
  for (int i = 0; i < 40; ++i) scale.add(onTheRound(i), onTheRound(i), 0);
  for (int i = 40; i < 84; ++i) scale.add(onTheRound(i), onTheRound(i) + Eigen::Vector3d(500, 0, 0), 1);
  EXPECT_NEAR(scale.ratio()->log, 0, 1e-9);
}

TEST(Stretch, IsTheMeanOfTheVotes) {
  // A map of one drive that is 2 % too large, if the second is right: each is believed as much.
  const Stretch second = stretchFor({0.02, 0}, 1, 0.01);
  EXPECT_NEAR(std::log(second.earlier), -0.01, 1e-12);
  EXPECT_NEAR(std::log(second.own), 0.01, 1e-12);
  // The mean of four drives moves by a fifth of what the fifth one says, and both meet.
  const Stretch fifth = stretchFor({0.02, 0}, 4, 0.01);
  EXPECT_NEAR(std::log(fifth.earlier), -0.004, 1e-12);
  EXPECT_NEAR(std::log(fifth.own) - std::log(fifth.earlier), 0.02, 1e-12);
}

TEST(Stretch, AnotherUnitHasNoVote) {
  for (const double log : {std::log(1000.0), std::log(0.3048), 0.1}) {
    EXPECT_EQ(stretchFor({log, 0.002}, 1, 0.01).earlier, 1);
    EXPECT_EQ(stretchFor({log, 0.002}, 1, 0.01).own, 1);
  }
}

TEST(Stretch, AVagueVoteCountsLittle) {
  EXPECT_NEAR(std::log(stretchFor({0.02, 0.1}, 1, 0.01).earlier), 0, 0.0002);
}

}  // namespace
}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "landings.h"

#include <gtest/gtest.h>

namespace engram::pipeline::landings_test {
namespace {

Eigen::Isometry3d pose(double x, double y, double heading) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, 0);
  return T;
}

constexpr double kWithin = 0.6;

TEST(Landings, TwoImagesOnTheWayBetweenThemAgree) {
  Landings landings;
  const Eigen::Isometry3d T_map_odom = pose(7, -3, 1.2);
  EXPECT_FALSE(landings.agree(4, T_map_odom * pose(1, 0, 0), pose(1, 0, 0), kWithin));
  EXPECT_TRUE(landings.agree(6, T_map_odom * pose(1.5, 0.2, 0.3), pose(1.5, 0.2, 0.3), kWithin));
}

TEST(Landings, OneImageIsNoWitnessForItself) {
  Landings landings;
  EXPECT_FALSE(landings.agree(4, pose(7, 0, 0), pose(1, 0, 0), kWithin));
  EXPECT_FALSE(landings.agree(4, pose(7, 0, 0), pose(1, 0, 0), kWithin));
}

TEST(Landings, AnyPoseOfTheImageBeforeIsAWitness) {
  Landings landings;
  landings.agree(4, pose(7, 0, 0), pose(1, 0, 0), kWithin);
  landings.agree(4, pose(90, 0, 0), pose(1, 0, 0), kWithin);
  EXPECT_TRUE(landings.agree(5, pose(7.5, 0, 0), pose(1.5, 0, 0), kWithin));
}

TEST(Landings, OtherPlacesAndOtherHeadingsDisagree) {
  Landings landings;
  landings.agree(4, pose(7, 0, 0), pose(1, 0, 0), kWithin);
  EXPECT_FALSE(landings.agree(5, pose(7.5, kWithin + 0.1, 0), pose(1.5, 0, 0), kWithin));
  EXPECT_FALSE(landings.agree(6, pose(8, kWithin + 0.1, 0.2), pose(2, 0, 0), kWithin));
}

TEST(Landings, WhatIsClearedCountsNoMore) {
  Landings landings;
  landings.agree(4, pose(7, 0, 0), pose(1, 0, 0), kWithin);
  landings.clear();
  EXPECT_FALSE(landings.agree(5, pose(7.5, 0, 0), pose(1.5, 0, 0), kWithin));
}

}  // namespace
}  // namespace engram::pipeline::landings_test

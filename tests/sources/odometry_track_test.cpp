// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/odometry_track.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::sources {
namespace {

void expectNear(const Pose2& a, const Pose2& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(std::remainder(a.heading - b.heading, 2 * M_PI), 0.0, tolerance);
}

TEST(OdometryTrack, HoldsTheEndsForALimitedTime) {
  OdometryTrack track;
  EXPECT_FALSE(track.at(10.0, 1.0));
  track.add(10.0, {1, 0, 0});
  track.add(11.0, {2, 0, 0});
  EXPECT_FALSE(track.at(8.9, 1.0));
  expectNear(*track.at(9.5, 1.0), {1, 0, 0});
  expectNear(*track.at(10.0, 1.0), {1, 0, 0});
  expectNear(*track.at(10.25, 1.0), {1.25, 0, 0});
  expectNear(*track.at(11.5, 1.0), {2, 0, 0});
  EXPECT_FALSE(track.at(12.1, 1.0));
  EXPECT_TRUE(track.covers(11.0));
  EXPECT_FALSE(track.covers(11.01));
}

TEST(OdometryTrack, ForgetsTheDistantPast) {
  OdometryTrack track;
  for (int i = 0; i < 20000; ++i) track.add(i, {static_cast<double>(i), 0, 0});
  EXPECT_FALSE(track.at(100.0, 1.0));
  expectNear(*track.at(19500.5, 1.0), {19500.5, 0, 0});
}

}  // namespace
}  // namespace engram::sources

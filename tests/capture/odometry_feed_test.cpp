// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_feed.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

namespace engram::capture {
namespace {

using namespace std::chrono_literals;

TEST(OdometryFeed, WaitsForTheReadingAfterTheImage) {
  OdometryFeed feed;
  feed.add(10.0, {1.0, 0.0, 0.0});
  std::thread sensor([&] {
    std::this_thread::sleep_for(30ms);
    feed.add(10.2, {3.0, 0.0, 0.0});
  });
  const auto pose = feed.at(10.1, 1.0, 5s);  // between both: interpolated, not held
  sensor.join();
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x, 2.0, 1e-12);
  EXPECT_EQ(feed.readings(), 2u);
}

TEST(OdometryFeed, HoldsTheLastReadingForAWhile) {
  OdometryFeed feed;
  EXPECT_FALSE(feed.at(10.0, 1.0, 0ms));
  feed.add(10.0, {1.0, 2.0, 0.5});
  EXPECT_EQ(feed.at(10.9, 1.0, 1ms)->y, 2.0);
  EXPECT_FALSE(feed.at(11.1, 1.0, 1ms));
}

TEST(OdometryFeed, LeavesOutWhatCannotBe) {
  OdometryFeed feed;
  feed.add(10.0, {1.0, 0.0, 0.0});
  feed.add(10.1, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  feed.add(9.0, {5.0, 0.0, 0.0});
  feed.add(10.0, {6.0, 0.0, 0.0});
  for (const double far : {1.7e308, -1.7e308, 1e154, 1e9}) feed.add(10.2, {far, 0.0, 0.0});
  EXPECT_EQ(feed.readings(), 1u);
  EXPECT_EQ(feed.leftOut(), 5u);
  for (int i = 0; i < 20; ++i) feed.add(5.0 + 0.1 * i, {9.0, 0.0, 0.0});  // the clock was set back for good
  EXPECT_EQ(feed.at(6.9, 1.0, 0ms)->x, 9.0);
}

}  // namespace
}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "watchdog.h"

#include <gtest/gtest.h>

#include <vector>

namespace engram::capture {
namespace {

using Advice = Watchdog::Advice;

TEST(Watchdog, FramesKeepItQuiet) {
  Watchdog dog({.silence = 2.0}, 0.0);
  dog.connected(0.0);
  for (double t = 0.0; t < 100.0; t += 1.9) {
    EXPECT_EQ(dog.advice(t), Advice::kWait);
    dog.frame(t);
  }
}

TEST(Watchdog, SilenceDropsTheConnection) {
  Watchdog dog({.silence = 2.0}, 0.0);
  dog.connected(10.0);
  EXPECT_EQ(dog.advice(11.99), Advice::kWait);  // the first frame may take its time
  EXPECT_EQ(dog.advice(12.0), Advice::kDrop);
  dog.frame(12.0);
  EXPECT_EQ(dog.advice(13.9), Advice::kWait);
  EXPECT_EQ(dog.advice(14.0), Advice::kDrop);
}

TEST(Watchdog, RareTriggersAreNoSilence) {
  Watchdog dog({.silence = 0.0}, 0.0);
  dog.connected(0.0);
  EXPECT_EQ(dog.advice(1e6), Advice::kWait);
}

/// The times of all attempts while the camera stays away.
std::vector<double> attempts(Watchdog& dog, double from, double to) {
  std::vector<double> times;
  for (double t = from; t < to; t += 0.125) {
    if (dog.advice(t) != Advice::kConnect) continue;
    times.push_back(t);
    dog.failed(t);
  }
  return times;
}

TEST(Watchdog, PausesDoubleUpToTheLongest) {
  Watchdog dog({.silence = 2.0, .firstDelay = 0.5, .longestDelay = 8.0}, 0.0);
  dog.connected(0.0);
  dog.frame(1.0);
  dog.lost(3.0);
  EXPECT_EQ(attempts(dog, 3.0, 40.0), (std::vector<double>{3.5, 4.5, 6.5, 10.5, 18.5, 26.5, 34.5}));
}

TEST(Watchdog, OnlyAFrameResetsThePauses) {
  Watchdog dog({.silence = 2.0, .firstDelay = 0.5, .longestDelay = 8.0}, 0.0);
  dog.connected(0.0);
  dog.lost(2.0);
  EXPECT_EQ(attempts(dog, 2.0, 5.6), (std::vector<double>{2.5, 3.5, 5.5}));
  dog.connected(9.5);
  EXPECT_EQ(dog.lostSince(), 2.0);  // connected, but nothing was seen
  dog.lost(11.5);
  EXPECT_EQ(dog.advice(19.4), Advice::kWait);  // 8 s, not 0.5 s
  dog.connected(19.5);
  dog.frame(19.6);
  EXPECT_FALSE(dog.lostSince());
  dog.lost(30.0);
  EXPECT_EQ(dog.lostSince(), 19.6);  // since the last frame
  EXPECT_EQ(dog.advice(30.5), Advice::kConnect);
}

TEST(Watchdog, GivesUpWhenTold) {
  Watchdog dog({.silence = 2.0, .giveUp = 20.0}, 0.0);
  dog.connected(0.0);
  dog.frame(5.0);
  dog.lost(7.0);
  attempts(dog, 7.0, 24.9);
  EXPECT_NE(dog.advice(24.9), Advice::kGiveUp);
  EXPECT_EQ(dog.advice(25.0), Advice::kGiveUp);
  dog.connected(25.0);
  dog.frame(25.0);
  EXPECT_EQ(dog.advice(26.0), Advice::kWait);
}

}  // namespace
}  // namespace engram::capture

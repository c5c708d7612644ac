// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/stamp_gate.h"

#include "stamp_queue.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace engram::sources {
namespace {

using Verdict = StampGate::Verdict;

TEST(StampGate, PassesRisingStampsOnly) {
  StampGate gate;
  EXPECT_EQ(gate.check(5.0), Verdict::kPass);
  EXPECT_EQ(gate.check(5.0), Verdict::kRepeated);
  EXPECT_EQ(gate.check(4.0), Verdict::kBackwards);
  EXPECT_EQ(gate.check(5.1), Verdict::kPass);
  EXPECT_EQ(gate.check(1e9), Verdict::kJump);
  EXPECT_EQ(gate.check(5.2), Verdict::kPass);
  EXPECT_EQ(gate.last(), 5.2);
}

TEST(StampGate, ClockSetBackForGoodStartsAnew) {
  StampGate gate;
  gate.check(1000.0);
  int refused = 0;
  double stamp = 10.0;
  while (gate.check(stamp) != Verdict::kRestart) {
    ++refused;
    stamp += 0.1;
    ASSERT_LT(refused, 100);
  }
  EXPECT_EQ(refused, 10);
  EXPECT_EQ(gate.check(stamp + 0.1), Verdict::kPass);
}

TEST(StampGate, StampStuckForeverNeverRestarts) {
  StampGate gate;
  gate.check(1000.0);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(gate.check(1000.0), Verdict::kRepeated);
  EXPECT_EQ(gate.check(1000.1), Verdict::kPass);
}

TEST(StampGate, ClockThatLeapsAheadForGoodStartsANewStretchSoon) {
  StampGate gate;
  EXPECT_EQ(gate.check(5.0), Verdict::kPass);
  EXPECT_EQ(gate.check(1.7e9), Verdict::kJump);
  EXPECT_EQ(gate.check(1.7e9 + 0.1), Verdict::kJump);
  EXPECT_EQ(gate.check(1.7e9 + 0.1), Verdict::kRepeated);
  EXPECT_EQ(gate.check(1.7e9 + 0.2), Verdict::kRestart);
  EXPECT_EQ(gate.jump(), 1.7e9 - 5.0);
  EXPECT_EQ(gate.check(1.7e9 + 0.3), Verdict::kPass);
}

TEST(StampGate, TellsHowFarTheClockWasSetBack) {
  StampGate gate;
  gate.check(1000.0);
  for (int i = 0; i <= 10; ++i) gate.check(10.0 + i);
  EXPECT_EQ(gate.jump(), -990.0);
}

std::vector<double> passedBy(StampQueue<std::size_t>& queue, const std::vector<double>& stamps) {
  std::vector<double> passed;
  const auto take = [&] {
    while (const auto next = queue.pop()) {
      EXPECT_EQ(stamps[next->item], next->stamp);
      passed.push_back(next->stamp);
    }
  };
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    queue.push(stamps[i], i);
    take();
  }
  queue.finish();
  take();
  return passed;
}

TEST(StampQueue, LosesNothingWhenTheClockWasSet) {
  std::vector<double> stamps;
  for (const double start : {1000.0, 1.7e9, 1.6e9, 3.0e9})  // ahead, back, ahead
    for (int i = 0; i < 20; ++i) stamps.push_back(start + 0.1 * i);
  StampQueue<std::size_t> queue;
  EXPECT_EQ(passedBy(queue, stamps), stamps);
  EXPECT_EQ(queue.counts().bad, 0u);
  EXPECT_EQ(queue.counts().setAhead, 2u);
  EXPECT_EQ(queue.counts().setBack, 1u);
}

TEST(StampQueue, RefusesSingleWildStampsAndCountsThem) {
  StampQueue<std::size_t> queue;
  const std::vector<double> passed = passedBy(queue, {1, 2, 9e9, 3, 3, 2.5, 4, 8e9, 8e9 + 1, 5, -7, 6, 9e9});
  EXPECT_EQ(passed, (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(queue.counts().bad, 7u);
  EXPECT_EQ(queue.counts().leaps, 4u);
  EXPECT_EQ(queue.counts().setBack + queue.counts().setAhead, 0u);
}

// What a writer lets pass, the reader of its file must not refuse.
TEST(StampQueue, WhatPassedOncePassesAgain) {
  std::mt19937 random(5);
  std::size_t refused = 0, restarts = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> stamps;
    double now = 1000;
    for (int i = 0; i < 200; ++i) {
      const auto what = random() % 40;
      if (what == 0) now += 5e8 * (1.0 + static_cast<double>(random() % 3));
      if (what == 1) now -= static_cast<double>(random() % 100);
      if (what == 2) now = 1000;
      const bool wild = what >= 3 && what <= 6;
      stamps.push_back(wild ? now + 1e9 * (static_cast<double>(random() % 9) - 4) : now);
      if (random() % 8 != 0) now += 0.1 * static_cast<double>(1 + random() % 3);  // else a repeated one
    }
    StampQueue<std::size_t> first, second;
    const auto passed = passedBy(first, stamps);
    EXPECT_EQ(passedBy(second, passed), passed) << trial;
    EXPECT_EQ(second.counts().bad, 0u) << trial;
    EXPECT_EQ(passed.size() + first.counts().bad, stamps.size());
    refused += first.counts().bad;
    restarts += first.counts().setBack + first.counts().setAhead;
  }
  EXPECT_GT(refused, 1000u);
  EXPECT_GT(restarts, 400u);
}

}  // namespace
}  // namespace engram::sources

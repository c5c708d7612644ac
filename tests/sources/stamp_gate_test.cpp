// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/stamp_gate.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace engram::sources

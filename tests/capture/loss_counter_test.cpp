// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/loss_counter.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

namespace engram::capture {
namespace {

/// What the loss counter finds when a camera numbers from `first` on and each frame is lost with `loss`.
void play(std::uint64_t first, bool wraps, bool usesZero, double loss) {
  base::Rng rng(static_cast<std::uint64_t>(1000 * loss) + first);
  LossCounter counter;
  std::uint64_t number = first;
  std::size_t lost = 0, pending = 0, whole = 0, incomplete = 0;
  for (int i = 0; i < 200000; ++i) {
    const bool isLost = i > 0 && rng.uniform() < loss;
    if (isLost) {
      ++pending;
    } else {
      const bool isWhole = rng.uniform() < 0.9;
      ASSERT_EQ(counter.arrived(number, isWhole), pending) << "at " << number;
      lost += std::exchange(pending, 0);
      ++(isWhole ? whole : incomplete);
    }
    if (wraps && number == 65535) {
      number = usesZero && !isLost ? 0 : 1;  // see ALostZeroIsNotSeen
    } else {
      ++number;
    }
  }
  EXPECT_EQ(counter.missed(), lost);
  EXPECT_EQ(counter.whole(), whole);
  EXPECT_EQ(counter.incomplete(), incomplete);
}

TEST(LossCounter, FindsEveryLossOverTheEndOfSixteenBits) {
  for (const double loss : {0.0, 0.01, 0.3}) play(65000, true, false, loss);
  play(65000, true, true, 0.0);
}

TEST(LossCounter, CountsSixtyFourBitNumbers) {
  play(0, false, false, 0.05);
  play(1ull << 40, false, false, 0.05);
}

TEST(LossCounter, ALostZeroIsNotSeen) {
  LossCounter counter;
  counter.arrived(65535, true);
  EXPECT_EQ(counter.arrived(1, true), 0u);  // most cameras have no number 0
}

TEST(LossCounter, ACameraThatCountsAnewHasLostNothing) {
  LossCounter counter;
  counter.arrived(40000, true);
  EXPECT_EQ(counter.arrived(40001, true), 0u);
  counter.restart();
  EXPECT_EQ(counter.arrived(7, true), 0u);
  EXPECT_EQ(counter.arrived(50000, true), 0u);  // a leap over more than half of all numbers
  EXPECT_EQ(counter.arrived(50000, true), 0u);  // repeated
  EXPECT_EQ(counter.arrived(49999, true), 0u);  // late
  EXPECT_EQ(counter.missed(), 0u);
}

}  // namespace
}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "loss_counter.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

namespace engram::capture {
namespace {

/// What the loss counter finds when a camera numbers from `first` on, each frame is lost with `loss`, and one
/// of ten of the others is incomplete.
void play(std::uint64_t first, bool wraps, bool usesZero, double loss) {
  base::Rng rng(static_cast<std::uint64_t>(1000 * loss) + first);
  LossCounter counter;
  std::uint64_t number = first;
  std::size_t lost = 0, pending = 0, whole = 0, incomplete = 0;
  for (int i = 0; i < 200000; ++i) {
    const bool isLost = i > 0 && rng.uniform() < loss;
    if (isLost) {
      ++pending;
    } else if (i > 0 && rng.uniform() < 0.1) {
      counter.incomplete();
      ++incomplete;
    } else {
      ASSERT_EQ(counter.whole(number), pending) << "at " << number;
      lost += std::exchange(pending, 0);
      ++whole;
    }
    if (wraps && number == 65535) {
      number = usesZero ? 0 : 1;
    } else {
      ++number;
    }
  }
  EXPECT_EQ(counter.missed(), lost);
  EXPECT_EQ(counter.wholeFrames(), whole);
  EXPECT_EQ(counter.incompleteFrames(), incomplete);
}

TEST(LossCounter, FindsEveryLossOverTheEndOfSixteenBits) {
  for (const double loss : {0.0, 0.01, 0.3}) play(65000, true, false, loss);
}

TEST(LossCounter, CountsSixtyFourBitNumbers) {
  play(0, false, false, 0.05);
  play(1ull << 40, false, false, 0.05);
}

TEST(LossCounter, SomeCamerasHaveANumberZero) {
  LossCounter zero;
  zero.whole(65534);
  EXPECT_EQ(zero.whole(65535), 0u);
  EXPECT_EQ(zero.whole(0), 0u);
  EXPECT_EQ(zero.whole(1), 0u);
  LossCounter counter;
  counter.whole(65535);
  EXPECT_EQ(counter.whole(1), 0u);  // most cameras have no number 0
}

TEST(LossCounter, ACameraThatCountsAnewHasLostNothing) {
  LossCounter counter;
  counter.whole(40000);
  EXPECT_EQ(counter.whole(40001), 0u);
  counter.restart();
  EXPECT_EQ(counter.whole(7), 0u);
  EXPECT_EQ(counter.whole(50000), 0u);  // a leap over more than half of all numbers
  EXPECT_EQ(counter.whole(50000), 0u);  // repeated
  EXPECT_EQ(counter.whole(49999), 0u);  // late
  EXPECT_EQ(counter.missed(), 0u);
}

}  // namespace
}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/bootstrap.h"

#include "engram/base/rng.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace engram::evaluation {
namespace {

using Samples = std::vector<BlockSample>;

/// Share of `trials` draws whose interval holds `truth`.
double coverage(double truth, int trials, const std::function<Interval(base::Rng&)>& draw) {
  base::Rng rng(11);
  int held = 0;
  for (int i = 0; i < trials; ++i) {
    const Interval interval = draw(rng);
    held += interval.low <= truth && truth <= interval.high;
  }
  return static_cast<double>(held) / trials;
}

BootstrapParams fast() {
  BootstrapParams p;
  p.resamples = 600;
  return p;
}

Samples binomial(base::Rng& rng, int n, double p) {
  Samples out;
  for (int i = 0; i < n; ++i) out.push_back({i, rng.uniform() < p ? 1.0 : 0.0});
  return out;
}

/// What all items of a block share is larger than what tells them apart.
Samples correlated(base::Rng& rng, int blocks, int items) {
  Samples out;
  for (int b = 0; b < blocks; ++b) {
    const double shared = rng.normal();
    for (int i = 0; i < items; ++i) out.push_back({b, 3 + shared + rng.normal(0, 0.3)});
  }
  return out;
}

TEST(Bootstrap, CoversTheMeanOfIndependentTrials) {
  const double share =
      coverage(0.3, 1000, [](base::Rng& rng) { return blockBootstrapMean(binomial(rng, 100, 0.3), fast()); });
  EXPECT_NEAR(share, 0.95, 0.025);
}

TEST(Bootstrap, TakesTheConfidenceItIsGiven) {
  BootstrapParams p = fast();
  p.confidence = 0.8;
  const double share =
      coverage(3, 1500, [&](base::Rng& rng) { return blockBootstrapMean(correlated(rng, 30, 1), p); });
  EXPECT_NEAR(share, 0.8, 0.035);
}

TEST(Bootstrap, CoversWithCorrelatedBlocksWhereSinglesDoNot) {
  for (const int blocks : {6, 10, 36}) {
    const auto drawBlocks = [&](base::Rng& rng) {
      return blockBootstrapMean(correlated(rng, blocks, 12), fast());
    };
    const auto drawSingles = [&](base::Rng& rng) {
      Samples singles = correlated(rng, blocks, 12);
      for (std::size_t i = 0; i < singles.size(); ++i) singles[i].block = static_cast<int>(i);
      return blockBootstrapMean(singles, fast());
    };
    EXPECT_NEAR(coverage(3, 1000, drawBlocks), 0.95, blocks < 8 ? 0.04 : 0.025) << blocks;
    EXPECT_LT(coverage(3, 150, drawSingles), 0.6) << blocks;
  }
}

TEST(Bootstrap, CoversRareFailures) {
  const auto failures = [](const std::function<Interval(const Samples&)>& interval) {
    return coverage(0.02, 2000, [&](base::Rng& rng) { return interval(binomial(rng, 36, 0.02)); });
  };
  // Half of these draws hold no failure at all, and a mean of zeros says "0 ± 0".
  EXPECT_LT(failures([](const Samples& s) { return blockBootstrapMean(s, fast()); }), 0.6);
  EXPECT_GT(failures([](const Samples& s) { return blockBootstrapShare(s, fast()); }), 0.95);
}

TEST(Bootstrap, DifferenceOfPairsIsCoveredAndNarrow) {
  const auto draw = [](base::Rng& rng, double& ratio) {
    Samples a = correlated(rng, 20, 5), b = a;
    for (BlockSample& s : b) s.value += 0.25 + rng.normal(0, 0.2);
    const Interval d = blockBootstrapDifference(b, a, fast());
    const Interval single = blockBootstrapMean(a, fast());
    ratio = (d.high - d.low) / (single.high - single.low);
    return d;
  };
  double worst = 0, ratio = 0;
  const double share = coverage(0.25, 800, [&](base::Rng& rng) {
    const Interval d = draw(rng, ratio);
    worst = std::max(worst, ratio);
    return d;
  });
  EXPECT_NEAR(share, 0.95, 0.025);
  EXPECT_LT(worst, 0.5);
}

TEST(Bootstrap, IsTheDifferenceOfTheMeans) {
  const Samples a{{1, 4, 2}, {1, 1, 1}, {2, 6, 3}}, b{{1, 1, 2}, {1, 1, 1}, {2, 2, 3}};
  const Interval d = blockBootstrapDifference(a, b);
  EXPECT_DOUBLE_EQ(d.value, blockBootstrapMean(a).value - blockBootstrapMean(b).value);
  EXPECT_DOUBLE_EQ(blockBootstrapMean(a).value, 27.0 / 6);
  EXPECT_EQ(d.blocks, 2);
  const Interval none = blockBootstrapDifference(a, a);
  EXPECT_EQ(none.low, 0);
  EXPECT_EQ(none.high, 0);
  EXPECT_FALSE(none.excludes(0));
}

// All 4^4 resamples, each as probable as the next.
TEST(Bootstrap, IsTheExactDistributionOfFewBlocks) {
  const Samples samples{{0, 1}, {1, 2}, {2, 4}, {3, 8}};
  std::vector<double> means;
  for (int code = 0; code < 256; ++code) {
    double sum = 0;
    for (int i = 0, rest = code; i < 4; ++i, rest /= 4)
      sum += samples[static_cast<std::size_t>(rest % 4)].value;
    means.push_back(sum / 4);
  }
  std::sort(means.begin(), means.end());
  BootstrapParams p;
  p.confidence = 0.5;
  p.resamples = 200000;
  // Student's t with 3 degrees of freedom has its 75 % point at 0.76489 (table).
  const double tail = 0.5 * std::erfc(std::sqrt(4.0 / 3) * 0.76489 / std::sqrt(2.0));
  const Interval interval = blockBootstrapMean(samples, p);
  EXPECT_EQ(interval.low, means[static_cast<std::size_t>(tail * 256)]);
  EXPECT_EQ(interval.high, means[static_cast<std::size_t>((1 - tail) * 256)]);
  EXPECT_EQ(interval.value, 3.75);
}

TEST(Bootstrap, SaysWhenTheSpreadIsNotKnown) {
  const Samples one{{7, 1}, {7, 3}, {7, 8}};
  for (const Interval& i : {blockBootstrapMean(one), blockBootstrapDifference(one, one)}) {
    EXPECT_EQ(i.blocks, 1);
    EXPECT_FALSE(i.known());
    EXPECT_TRUE(std::isnan(i.low) && std::isnan(i.high));
    EXPECT_FALSE(i.excludes(1000));
  }
  EXPECT_EQ(blockBootstrapMean(one).value, 4);
  const Interval none = blockBootstrapMean({});
  EXPECT_EQ(none.blocks, 0);
  EXPECT_TRUE(std::isnan(none.value) && std::isnan(none.low) && std::isnan(none.high));
  // A block without weight is no block.
  EXPECT_EQ(blockBootstrapMean(Samples{{1, 2}, {2, 9, 0}}).blocks, 1);
  EXPECT_TRUE(std::isnan(blockBootstrapShare(Samples{{1, 1}, {1, 1}}).low));
}

TEST(Bootstrap, OfEqualSamplesHasNoWidth) {
  const Samples same{{0, 2.5}, {0, 2.5}, {1, 2.5, 4}, {2, 2.5}};
  const Interval i = blockBootstrapMean(same);
  EXPECT_EQ(i.value, 2.5);
  EXPECT_EQ(i.low, 2.5);
  EXPECT_EQ(i.high, 2.5);
  EXPECT_TRUE(i.excludes(2.4));
  Samples tenths;
  for (int b = 0; b < 37; ++b) tenths.push_back({b, 0.1, 1 + 0.1 * b});
  const Interval t = blockBootstrapMean(tenths);
  EXPECT_LE(t.low, t.value);
  EXPECT_GE(t.high, t.value);
  EXPECT_NEAR(t.high - t.low, 0, 1e-15);
}

TEST(Bootstrap, BoundsTheShareThatWasNeverSeen) {
  Samples never, always;
  for (int b = 0; b < 36; ++b) {
    never.push_back({b, 0});
    always.push_back({b, 1});
  }
  const Interval zero = blockBootstrapShare(never), all = blockBootstrapShare(always);
  EXPECT_EQ(zero.low, 0);
  // The probability of 36 blocks without one when the share is `high` is 2.5 %.
  EXPECT_NEAR(std::pow(1 - zero.high, 36), 0.025, 1e-12);
  EXPECT_EQ(all.high, 1);
  EXPECT_DOUBLE_EQ(all.low, 1 - zero.high);
  // Elsewhere it is the plain interval.
  never[3].value = 1;
  EXPECT_EQ(blockBootstrapShare(never).high, blockBootstrapMean(never).high);
}

TEST(Bootstrap, DependsOnTheSeedOnly) {
  base::Rng rng(5);
  Samples samples = correlated(rng, 12, 6);
  for (BlockSample& s : samples) s.value = std::round(s.value * 64) / 64;  // sums in any order are exact
  const Interval first = blockBootstrapMean(samples);
  Samples shuffled = samples;
  for (std::size_t i = shuffled.size(); i > 1; --i)
    std::swap(shuffled[i - 1], shuffled[rng.below(static_cast<std::uint32_t>(i))]);
  const Interval again = blockBootstrapMean(shuffled);
  EXPECT_EQ(first.low, again.low);
  EXPECT_EQ(first.high, again.high);
  BootstrapParams other;
  other.seed = 2;
  EXPECT_NE(first.low, blockBootstrapMean(samples, other).low);
  // Moves and scales with the values.
  for (BlockSample& s : samples) s.value = 4 * s.value - 8;
  EXPECT_DOUBLE_EQ(blockBootstrapMean(samples).low, 4 * first.low - 8);
}

TEST(Bootstrap, RefusesWhatItCannotUse) {
  const auto message = [](const std::function<void()>& call) -> std::string {
    try {
      call();
    } catch (const base::Error& e) {
      return e.what();
    }
    return "";
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(message([] {
                blockBootstrapMean(Samples{{0, 1}, {4, std::nan("")}});
              }),
              HasSubstr("sample 1 (block 4)"));
  EXPECT_THAT(message([] { blockBootstrapMean(Samples{{0, 1, -1}}); }), HasSubstr("weight"));
  EXPECT_THAT(message([] { blockBootstrapShare(Samples{{0, 1.5}}); }), HasSubstr("no share"));
  EXPECT_THAT(message([] { blockBootstrapDifference(Samples{{0, 1}}, Samples{}); }), HasSubstr("same items"));
  EXPECT_THAT(message([] {
                blockBootstrapDifference(Samples{{0, 1}, {1, 1}}, Samples{{0, 1}, {2, 1}});
              }),
              HasSubstr("sample 1 is of block 1"));
  EXPECT_THAT(message([] { blockBootstrapMean({}, {.resamples = 3, .confidence = 0.95, .seed = 1}); }),
              HasSubstr("bootstrap_resamples"));
}

}  // namespace
}  // namespace engram::evaluation

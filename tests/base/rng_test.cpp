// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace engram::base {
namespace {

/// xoshiro256** and SplitMix64 as their authors publish them.
struct Reference {
  std::uint64_t s[4];
  static std::uint64_t rotl(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  static std::uint64_t splitMix(std::uint64_t& x) {
    std::uint64_t z = (x += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  std::uint64_t next() {
    const std::uint64_t result = rotl(s[1] * 5, 7) * 9;
    const std::uint64_t t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotl(s[3], 45);
    return result;
  }
};

TEST(Rng, IsXoshiro256StarStar) {
  Reference small{{1, 2, 3, 4}};  // the published answers for this state
  EXPECT_EQ(small.next(), 11520u);
  EXPECT_EQ(small.next(), 0u);
  EXPECT_EQ(small.next(), 1509978240u);
  EXPECT_EQ(small.next(), 1215971899390074240u);
  std::uint64_t zero = 0;
  EXPECT_EQ(Reference::splitMix(zero), 0xE220A8397B1DCDAFu);  // likewise

  for (const std::uint64_t seed : {0ull, 1ull, 42ull, 0xFFFFFFFFFFFFFFFFull}) {
    std::uint64_t x = seed;
    Reference reference{};
    for (auto& s : reference.s) s = Reference::splitMix(x);
    Rng rng(seed);
    for (int i = 0; i < 1000; ++i) ASSERT_EQ(rng.bits(), reference.next());
  }
}

TEST(Rng, RepeatsForOneSeedAndDiffersForOthers) {
  Rng a(7), b(7), c(8);
  std::set<std::uint64_t> seen;
  for (int i = 0; i < 100; ++i) {
    const auto x = a.bits();
    EXPECT_EQ(x, b.bits());
    EXPECT_NE(x, c.bits());
    EXPECT_TRUE(seen.insert(x).second);
  }
}

TEST(Rng, UniformFillsItsInterval) {
  Rng rng(1);
  constexpr int kBins = 20, kDraws = 200000;
  std::vector<int> bins(kBins);
  double sum = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    ++bins[static_cast<std::size_t>(u * kBins)];
    sum += u;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 4 * std::sqrt(1.0 / 12 / kDraws));
  double chi2 = 0;
  for (const int n : bins) chi2 += std::pow(n - kDraws / kBins, 2) / (kDraws / kBins);
  EXPECT_LT(chi2, 43.8);  // 0.999 quantile for 19 degrees of freedom
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.uniform(-3, -1);
    ASSERT_TRUE(u >= -3 && u < -1);
  }
}

TEST(Rng, BelowIsUniformWithoutModuloBias) {
  Rng rng(2);
  for (const std::uint32_t n : {1u, 2u, 7u, 10u}) {
    const int draws = 20000 * static_cast<int>(n);
    std::vector<int> counts(n);
    for (int i = 0; i < draws; ++i) {
      const auto x = rng.below(n);
      ASSERT_LT(x, n);
      ++counts[x];
    }
    for (const int count : counts) EXPECT_NEAR(count, 20000, 5 * std::sqrt(20000.0));
  }
  // With a plain modulus the lower third of 3 * 2^30 would be hit half of the time.
  constexpr std::uint32_t kLarge = 3u << 30;
  int lower = 0;
  for (int i = 0; i < 30000; ++i) lower += rng.below(kLarge) < kLarge / 3;
  EXPECT_NEAR(lower, 10000, 5 * std::sqrt(30000 * 2.0 / 9));
}

TEST(Rng, NormalHasTheMomentsAndTailsOfAGaussian) {
  Rng rng(3);
  constexpr int kDraws = 400000;
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  int beyond2 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = rng.normal();
    m1 += x / kDraws;
    m2 += x * x / kDraws;
    m3 += x * x * x / kDraws;
    m4 += x * x * x * x / kDraws;
    beyond2 += std::abs(x) > 2;
  }
  EXPECT_NEAR(m1, 0, 5 / std::sqrt(kDraws));
  EXPECT_NEAR(m2, 1, 5 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(m3, 0, 5 * std::sqrt(15.0 / kDraws));
  EXPECT_NEAR(m4, 3, 5 * std::sqrt(96.0 / kDraws));
  EXPECT_NEAR(static_cast<double>(beyond2) / kDraws, std::erfc(2 / std::sqrt(2.0)), 0.002);
  double sum = 0;
  for (int i = 0; i < 10000; ++i) sum += rng.normal(5, 0.1) / 10000;
  EXPECT_NEAR(sum, 5, 0.005);
}

TEST(Rng, ForksAreReproducibleAndDoNotAdvanceTheirSource) {
  Rng a(9), b(9);
  Rng first = a.fork(1), again = a.fork(1), second = a.fork(2);
  EXPECT_EQ(a.bits(), b.bits());
  int equal = 0;
  double product = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto x = first.bits();
    EXPECT_EQ(x, again.bits());
    const auto y = second.bits();
    equal += x == y;
    product +=
        (static_cast<double>(x >> 11) * 0x1p-53 - 0.5) * (static_cast<double>(y >> 11) * 0x1p-53 - 0.5);
  }
  EXPECT_EQ(equal, 0);
  EXPECT_NEAR(product / 10000, 0, 5.0 / 12 / 100);
}

}  // namespace
}  // namespace engram::base

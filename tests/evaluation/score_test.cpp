// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/score.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace engram::evaluation {
namespace {

LocalisationResult result(bool accepted, Verdict verdict, Verdict bestGuess) {
  LocalisationResult r;
  r.accepted = accepted;
  r.verdict = verdict;
  r.bestGuess = bestGuess;
  return r;
}

TEST(Score, CountsWhatItSays) {
  const auto R = Verdict::kRight, W = Verdict::kWrong, U = Verdict::kUnknown;
  std::vector<LocalisationResult> results{result(true, R, R),  result(true, R, R),  result(true, W, W),
                                          result(false, U, R), result(false, U, W), result(true, U, U),
                                          result(false, U, U)};
  results[0].error = 0.5;
  results[2].error = 4.5;
  results[4].answerable = false;
  const auto s = score(results);
  EXPECT_EQ(s.images, 7);
  EXPECT_EQ(s.queries, 5);
  EXPECT_EQ(s.answerable, 4);
  EXPECT_EQ(s.accepted, 3);
  EXPECT_EQ(s.right, 2);
  EXPECT_EQ(s.wrong, 1);
  EXPECT_EQ(s.bestGuessRight, 3);
  EXPECT_EQ(s.accepted, s.right + s.wrong);
  EXPECT_NEAR(s.precision(), 2.0 / 3, 1e-12);
  EXPECT_NEAR(s.recall(), 0.5, 1e-12);
  EXPECT_EQ(s.error.count, 2);
  EXPECT_NEAR(s.error.mean, 2.5, 1e-12);
}

TEST(Score, OfNothingIsZero) {
  const auto s = score({});
  EXPECT_EQ(s.images, 0);
  EXPECT_EQ(s.precision(), 0);
  EXPECT_EQ(s.recall(), 0);
}

TEST(Percentiles, AreTheNearestRank) {
  std::vector<double> values;
  for (int i = 1; i <= 100; ++i) values.push_back(i);
  base::Rng rng(1);
  for (std::uint32_t i = 100; i > 1; --i) std::swap(values[i - 1], values[rng.below(i)]);
  const auto p = percentiles(values);
  EXPECT_EQ(p.median, 50);
  EXPECT_EQ(p.p95, 95);
  EXPECT_EQ(p.min, 1);
  EXPECT_EQ(p.max, 100);
  EXPECT_NEAR(p.mean, 50.5, 1e-12);
  const auto one = percentiles({7});
  EXPECT_EQ(one.median, 7);
  EXPECT_EQ(one.p95, 7);
  EXPECT_EQ(percentiles({1, 2}).p95, 2);
}

// Their definition, by brute force.
TEST(Percentiles, AreTheSmallestValueWithThatShareAtOrBelow) {
  base::Rng rng(2);
  for (int n = 1; n < 60; ++n) {
    std::vector<double> values(static_cast<std::size_t>(n));
    for (double& v : values) v = rng.below(20);
    const double p95 = percentiles(values).p95;
    const auto atOrBelow = [&](double x) {
      return std::ranges::count_if(values, [&](double v) { return v <= x; });
    };
    EXPECT_GE(atOrBelow(p95) * 100, 95 * n);
    for (const double v : values) EXPECT_TRUE(v >= p95 || atOrBelow(v) * 100 < 95 * n);
  }
}

}  // namespace
}  // namespace engram::evaluation

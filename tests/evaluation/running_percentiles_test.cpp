// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/running_percentiles.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace engram::evaluation {
namespace {

// Against the sorted sample: sizes from one to many, values over nine decades.
TEST(RunningPercentiles, AreThoseOfTheWholeSampleWithinHalfAPercent) {
  base::Rng rng(3);
  for (const int n : {1, 2, 19, 20, 21, 1000, 20000}) {
    std::vector<double> values;
    RunningPercentiles running;
    for (int i = 0; i < n; ++i) {
      values.push_back(std::pow(10.0, rng.uniform(-5.0, 4.0)));
      running.add(values.back());
    }
    const Percentiles truth = percentiles(values), p = running.summary();
    EXPECT_EQ(p.count, n);
    EXPECT_EQ(p.min, truth.min);
    EXPECT_EQ(p.max, truth.max);
    EXPECT_NEAR(p.mean, truth.mean, 1e-9 * truth.mean);
    EXPECT_NEAR(p.median, truth.median, 0.005 * truth.median) << n;
    EXPECT_NEAR(p.p95, truth.p95, 0.005 * truth.p95) << n;
  }
}

TEST(RunningPercentiles, StayWithinTheValuesSeen) {
  RunningPercentiles running;
  EXPECT_EQ(running.summary().p95, 0);
  for (int i = 0; i < 30; ++i) running.add(40.0);
  EXPECT_EQ(running.summary().median, 40.0);
  RunningPercentiles early;  // a clock that runs ahead makes a latency below zero
  early.add(-3.0);
  early.add(0.0);
  EXPECT_EQ(early.summary().min, -3.0);
  EXPECT_EQ(early.summary().max, 0.0);
  EXPECT_LE(early.summary().p95, 0.0);
}

}  // namespace
}  // namespace engram::evaluation

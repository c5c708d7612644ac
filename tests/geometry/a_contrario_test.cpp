// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "a_contrario.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::geometry {
namespace {

double choose(int n, int k) {
  double out = 1;
  for (int i = 1; i <= k; ++i) out *= static_cast<double>(n - k + i) / i;
  return out;
}

double bruteForce(int n, int k, double p, int sample, int models) {
  double tail = 0;
  for (int i = k - sample; i <= n - sample; ++i)
    tail += choose(n - sample, i) * std::pow(p, i) * std::pow(1 - p, n - sample - i);
  return std::log10(models * choose(n, sample) * tail);
}

TEST(FalseAlarms, AgreesWithTheBinomialSum) {
  for (const int n : {10, 30, 100})
    for (const double p : {0.01, 0.1, 0.5})
      for (int k = 3; k <= n; k += 4) {
        EXPECT_NEAR(log10FalseAlarms(n, k, p), bruteForce(n, k, p, 2, 2), 1e-6) << n << " " << k << " " << p;
        if (k > 5) {
          EXPECT_NEAR(log10FalseAlarms(n, k, p, 5, 20), bruteForce(n, k, p, 5, 20), 1e-6) << n << " " << k;
        }
      }
}

TEST(FalseAlarms, Extremes) {
  EXPECT_NEAR(log10FalseAlarms(50, 2, 0.1), std::log10(50 * 49), 1e-9);  // a sample always agrees with itself
  EXPECT_NEAR(log10FalseAlarms(50, 50, 1), std::log10(50 * 49), 1e-9);
  EXPECT_TRUE(std::isinf(log10FalseAlarms(50, 10, 0)));
  EXPECT_TRUE(std::isfinite(log10FalseAlarms(5000, 4000, 0.01)));
  EXPECT_GT(log10FalseAlarms(3, 0, 0.1), 0);
}

TEST(FalseAlarms, MoreInliersOrFewerAccidentsAreBetter) {
  for (int k = 3; k < 60; ++k) {
    EXPECT_LT(log10FalseAlarms(60, k + 1, 0.05), log10FalseAlarms(60, k, 0.05));
    EXPECT_LT(log10FalseAlarms(60, k, 0.04), log10FalseAlarms(60, k, 0.05));
  }
}

}  // namespace
}  // namespace engram::geometry

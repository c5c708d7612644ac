// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "a_contrario.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace engram::geometry {
namespace {

// Not std::lgamma: it writes a global variable.
double logChoose(int n, int k) {
  double sum = 0;
  for (int i = 1; i <= k; ++i) sum += std::log(static_cast<double>(n - k + i) / i);
  return sum;
}

/// log P(X >= k) of a binomial variable, summed relative to its largest term.
double logBinomialTail(int n, int k, double p) {
  if (k <= 0) return 0;
  if (k > n || p <= 0) return -std::numeric_limits<double>::infinity();
  if (p >= 1) return 0;
  const int first = std::max(k, std::min(n, static_cast<int>((n + 1) * p)));
  const double largest = logChoose(n, first) + first * std::log(p) + (n - first) * std::log1p(-p);
  const double odds = p / (1 - p);
  double sum = 1;
  double term = 1;
  for (int i = first; i < n; ++i) sum += term *= odds * (n - i) / (i + 1);
  term = 1;
  for (int i = first; i > k; --i) sum += term *= i / (odds * (n - i + 1));
  return std::min(0.0, largest + std::log(sum));
}

}  // namespace

double log10FalseAlarms(int matches, int inliers, double p, int sampleSize, int modelsPerSample) {
  const double models = std::log(modelsPerSample) + logChoose(matches, std::min(sampleSize, matches));
  return (models + logBinomialTail(matches - sampleSize, inliers - sampleSize, p)) / std::log(10.0);
}

}  // namespace engram::geometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/bootstrap.h"

#include "engram/base/rng.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace engram::evaluation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Sum {
  double weight = 0, weighted = 0;
};

void check(const BlockSample& s, std::size_t item) {
  const std::string where = "sample " + std::to_string(item) + " (block " + std::to_string(s.block) + "): ";
  if (!std::isfinite(s.value))
    throw base::Error(where + "its value is not finite; leave it out or give it a number");
  if (!std::isfinite(s.weight) || s.weight < 0)
    throw base::Error(where + "its weight " + std::to_string(s.weight) + " must be 0 or more");
}

/// In the order of block numbers, so that the order of the samples does not decide which block is drawn.
std::vector<Sum> sumsOfBlocks(std::span<const BlockSample> samples) {
  std::map<int, Sum> sums;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    check(samples[i], i);
    if (samples[i].weight == 0) continue;
    Sum& sum = sums[samples[i].block];
    sum.weight += samples[i].weight;
    sum.weighted += samples[i].weight * samples[i].value;
  }
  std::vector<Sum> out;
  for (const auto& [block, sum] : sums) out.push_back(sum);
  return out;
}

double normalCdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

double normalQuantile(double p) {
  double low = -40, high = 40;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (normalCdf(middle) < p ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Quantile of Student's t: closed forms for 1 and 2 degrees of freedom, else Abramowitz & Stegun 26.7.5.
double studentQuantile(double p, int freedom) {
  if (freedom == 1) return std::tan(M_PI * (p - 0.5));
  if (freedom == 2) return (2 * p - 1) / std::sqrt(2 * p * (1 - p));
  const double z = normalQuantile(p), z2 = z * z, v = freedom;
  const double g1 = z * (z2 + 1) / 4;
  const double g2 = z * ((5 * z2 + 16) * z2 + 3) / 96;
  const double g3 = z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384;
  const double g4 = z * ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / 92160;
  return z + (g1 + (g2 + (g3 + g4 / v) / v) / v) / v;
}

/// Share of the resamples below the interval. Percentiles of n blocks are too narrow by √((n-1)/n) and by
/// what Student's t is wider than the normal; Hesterberg 2015, section 3.3 takes both into the percentile.
double expandedTail(double confidence, std::size_t blocks) {
  const auto n = static_cast<double>(blocks);
  const double t = studentQuantile((1 + confidence) / 2, static_cast<int>(blocks) - 1);
  return normalCdf(-std::sqrt(n / (n - 1)) * t);
}

/// Of sorted values, linear between neighbours.
double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), sorted.size() - 1);
  const auto next = std::min(i + 1, sorted.size() - 1);
  return sorted[i] + (at - static_cast<double>(i)) * (sorted[next] - sorted[i]);
}

double meanOf(const Sum& sum) { return sum.weighted / sum.weight; }

}  // namespace

void BootstrapParams::describe(base::Params& p) {
  p.add("bootstrap_resamples", resamples, "number of resamples behind a confidence interval", {100, 1e6});
  p.add("bootstrap_confidence", confidence, "probability that an interval holds the true value",
        {0.5, 0.999});
  p.add("bootstrap_seed", seed, "seed of the resampling", base::atLeast(0));
}

Interval blockBootstrapMean(std::span<const BlockSample> samples, const BootstrapParams& params) {
  base::validate(params);
  const std::vector<Sum> blocks = sumsOfBlocks(samples);
  Interval out{kNaN, kNaN, kNaN, static_cast<int>(blocks.size())};
  if (blocks.empty()) return out;
  const auto add = [](Sum a, const Sum& b) { return Sum{a.weight + b.weight, a.weighted + b.weighted}; };
  Sum all;
  for (const Sum& b : blocks) all = add(all, b);
  out.value = meanOf(all);
  if (!out.known()) return out;

  base::Rng rng(static_cast<std::uint64_t>(params.seed));
  std::vector<double> means(static_cast<std::size_t>(params.resamples));
  for (double& mean : means) {
    Sum drawn;
    for (std::size_t i = 0; i < blocks.size(); ++i)
      drawn = add(drawn, blocks[rng.below(static_cast<std::uint32_t>(blocks.size()))]);
    mean = meanOf(drawn);
  }
  std::sort(means.begin(), means.end());
  const double tail = expandedTail(params.confidence, blocks.size());
  // Rounding must not put the value beside an interval of no width.
  out.low = std::min(out.value, quantile(means, tail));
  out.high = std::max(out.value, quantile(means, 1 - tail));
  return out;
}

Interval blockBootstrapShare(std::span<const BlockSample> samples, const BootstrapParams& params) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples[i].value < 0 || samples[i].value > 1)
      throw base::Error("sample " + std::to_string(i) + ": " + std::to_string(samples[i].value) +
                        " is no share; give values within 0 and 1");
  Interval out = blockBootstrapMean(samples, params);
  if (!out.known()) return out;
  const auto always = [&](double v) {
    return std::all_of(samples.begin(), samples.end(),
                       [&](const BlockSample& s) { return s.weight == 0 || s.value == v; });
  };
  const double unseen = 1 - std::pow((1 - params.confidence) / 2, 1.0 / out.blocks);
  if (always(0)) out = {0, 0, unseen, out.blocks};
  if (always(1)) out = {1, 1 - unseen, 1, out.blocks};
  return out;
}

Interval blockBootstrapDifference(std::span<const BlockSample> a, std::span<const BlockSample> b,
                                  const BootstrapParams& params) {
  if (a.size() != b.size())
    throw base::Error("paired difference: " + std::to_string(a.size()) + " and " + std::to_string(b.size()) +
                      " samples; give both methods the same items");
  std::vector<BlockSample> difference(a.begin(), a.end());
  for (std::size_t i = 0; i < a.size(); ++i) {
    check(a[i], i);
    check(b[i], i);
    if (a[i].block != b[i].block || a[i].weight != b[i].weight)
      throw base::Error("paired difference: sample " + std::to_string(i) + " is of block " +
                        std::to_string(a[i].block) + " with weight " + std::to_string(a[i].weight) +
                        " in one list and of block " + std::to_string(b[i].block) + " with weight " +
                        std::to_string(b[i].weight) + " in the other; give both methods the same items");
    difference[i].value -= b[i].value;
  }
  return blockBootstrapMean(difference, params);
}

}  // namespace engram::evaluation

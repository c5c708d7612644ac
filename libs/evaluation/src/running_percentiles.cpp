// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/running_percentiles.h"

#include <algorithm>
#include <cmath>

namespace engram::evaluation {
namespace {

constexpr double kGrowth = 1.01;
constexpr double kSmallest = 1e-6;

int binOf(double value) {
  return static_cast<int>(std::floor(std::log(std::max(value, kSmallest) / kSmallest) / std::log(kGrowth)));
}

/// As far, in percent, from the lower end as from the upper one.
double middleOf(int bin) { return kSmallest * std::pow(kGrowth, bin + 0.5); }

}  // namespace

void RunningPercentiles::add(double value) {
  min_ = count_ == 0 ? value : std::min(min_, value);
  max_ = count_ == 0 ? value : std::max(max_, value);
  sum_ += value;
  ++count_;
  ++bins_[binOf(value)];
}

double RunningPercentiles::atRank(double share) const {
  const auto rank = static_cast<std::uint64_t>(std::max(1.0, std::ceil(share * count_ - 1e-9)));
  std::uint64_t atOrBelow = 0;
  for (const auto& [bin, n] : bins_) {
    atOrBelow += n;
    if (atOrBelow >= rank) return std::clamp(middleOf(bin), min_, max_);
  }
  return max_;
}

Percentiles RunningPercentiles::summary() const {
  if (count_ == 0) return {};
  return {count_, sum_ / count_, min_, atRank(0.5), atRank(0.95), max_};
}

}  // namespace engram::evaluation

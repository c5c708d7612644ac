// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/sequence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace engram::belief {
namespace {

constexpr double kNormalQuartile = 1.4826;  // standard deviation over the median distance
constexpr double kLeastSpread = 1e-9;
constexpr double kLeast = -4, kMost = 12;  // deviates of one image that count: no image decides alone

double middle(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// log10 of the upper tail of the normal distribution; by its asymptote where the tail itself underflows.
double log10Tail(double deviates) {
  constexpr double kFar = 30;
  if (deviates < kFar) return std::log10(0.5 * std::erfc(deviates / std::numbers::sqrt2));
  return (-0.5 * deviates * deviates - std::log(deviates * std::sqrt(2 * std::numbers::pi))) /
         std::numbers::ln10;
}

}  // namespace

void Sequence::add(std::span<const double> deviates, const Adjacency& adjacency, int reach) {
  if (deviates.size() != adjacency.size())
    throw std::invalid_argument("Sequence::add: another number of places");
  if (sums_.size() != deviates.size()) {  // places came or went: what was seen before is of another map
    sums_.assign(deviates.size(), 0.0);
    seen_ = 0;
  }
  const double keep = 1.0 - 1.0 / images_;
  std::vector<double> sums(deviates.size());
  last_.assign(deviates.size(), 0.0);
  HopSearch search(adjacency);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    double before = -std::numeric_limits<double>::infinity();
    for (const Hop& hop : search.within(static_cast<int>(i), reach))
      before = std::max(before, sums_[static_cast<std::size_t>(hop.place)]);
    last_[i] = std::clamp(deviates[i], kLeast, kMost);
    sums[i] = last_[i] + keep * before;
  }
  sums_ = std::move(sums);
  ++seen_;
}

void Sequence::reset() {
  sums_.clear();
  last_.clear();
  seen_ = 0;
}

Sequence::Peak Sequence::peak(const Adjacency& adjacency, int around) const {
  Peak peak;
  if (seen_ == 0 || sums_.empty()) return peak;
  const double median = middle(sums_);
  std::vector<double> off(sums_);
  for (double& value : off) value = std::abs(value - median);
  const double spread = std::max(kLeastSpread, kNormalQuartile * middle(std::move(off)));
  const auto best = std::max_element(sums_.begin(), sums_.end()) - sums_.begin();
  peak.place = static_cast<int>(best);
  peak.deviates = (sums_[static_cast<std::size_t>(best)] - median) / spread;
  peak.log10Nfa = std::log10(static_cast<double>(sums_.size())) + log10Tail(peak.deviates);

  std::vector<bool> isNear(sums_.size(), false);
  HopSearch search(adjacency);
  peak.lastImage = kLeast;
  for (const Hop& hop : search.within(peak.place, around)) {
    isNear[static_cast<std::size_t>(hop.place)] = true;
    if (hop.hops <= 1) peak.lastImage = std::max(peak.lastImage, last_[static_cast<std::size_t>(hop.place)]);
  }
  peak.rival = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sums_.size(); ++i)
    if (!isNear[i]) peak.rival = std::max(peak.rival, (sums_[i] - median) / spread);
  return peak;
}

}  // namespace engram::belief

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/stamp_statistics.h"

#include <algorithm>
#include <cmath>

namespace engram::capture {
namespace {

/// The value below which a share of all values lies; `values` not empty.
double quantile(std::vector<double> values, double share) {
  const auto n = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + n, values.end());
  return values[static_cast<std::size_t>(n)];
}

/// The time from image to image of a camera that runs freely, however many images were lost: the shortest
/// intervals are whole ones, and all others are multiples of them. The median where they are not, as when the
/// images were taken at will.
double period(const std::vector<double>& intervals) {
  const double shortest = quantile(intervals, 0.05);
  const auto meanNear = [&intervals](double guess) {
    double sum = 0.0;
    std::size_t n = 0;
    for (const double interval : intervals)
      if (interval > 0.5 * guess && interval < 1.5 * guess) {
        sum += interval;
        ++n;
      }
    return n > 0 ? sum / static_cast<double>(n) : guess;
  };
  const double unit = meanNear(meanNear(shortest));
  const auto multiples = std::count_if(intervals.begin(), intervals.end(), [unit](double interval) {
    const double n = interval / unit;
    return std::abs(n - std::round(n)) < 0.2;
  });
  constexpr double kMost = 0.8;  // by chance it would be 0.4
  return static_cast<double>(multiples) >= kMost * static_cast<double>(intervals.size())
             ? unit
             : quantile(intervals, 0.5);
}

}  // namespace

void StampStatistics::add(double stamp) { stamps_.push_back(stamp); }

StampStatistics::Summary StampStatistics::summary() const {
  Summary s;
  s.images = stamps_.size();
  if (stamps_.empty()) return s;
  s.first = stamps_.front();
  s.last = stamps_.back();
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps_.size(); ++i)
    if (stamps_[i] > stamps_[i - 1]) intervals.push_back(stamps_[i] - stamps_[i - 1]);
  if (intervals.empty()) return s;
  s.rate = static_cast<double>(intervals.size()) / (s.last - s.first);
  s.interval = period(intervals);
  s.interval95 = quantile(intervals, 0.95);
  s.longest = *std::max_element(intervals.begin(), intervals.end());
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    const double length = stamps_[i] - stamps_[i - 1];
    if (length < 1.5 * s.interval) continue;
    s.gaps.push_back(
        {stamps_[i - 1], length, static_cast<std::size_t>(std::lround(length / s.interval)) - 1});
    s.missing += s.gaps.back().missing;
  }
  for (double& interval : intervals)
    interval = std::abs(interval - std::max(1.0, std::round(interval / s.interval)) * s.interval);
  s.jitter = quantile(intervals, 0.5);
  return s;
}

}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "clock_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace engram::capture {
namespace {

constexpr double kBucket = 1.0;         // [s] of which the quickest arrival is kept
constexpr double kWindow = 120.0;       // [s]
constexpr double kSpanForDrift = 10.0;  // [s] below which jitter would be taken for drift
constexpr double kMaxDrift = 5e-4;      // of two quartz clocks, several times over
constexpr double kLost = 1.0;           // [s] away from the line: one of the clocks was set
constexpr int kPatience = 10;
constexpr std::int64_t kLeastStep = 1000;  // [ns]

double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

}  // namespace

void ClockMap::restart() {
  if (running_) ++restarts_;
  running_ = false;
}

void ClockMap::begin(std::int64_t device, std::int64_t arrival) {
  running_ = true;
  deviceOrigin_ = device;
  hostOrigin_ = arrival;
  quickest_.clear();
  offset_ = drift_ = 0.0;
  late_ = 0;
  lastHost_ =
      std::numeric_limits<std::int64_t>::min() / 2;  // when the host's clock is set back, stamps follow
}

std::int64_t ClockMap::toHost(std::int64_t device, std::int64_t arrival) {
  if (running_ && device < lastDevice_) restart();
  if (!running_) begin(device, arrival);
  const auto since = [&] {
    const double d = seconds(device - deviceOrigin_);
    return Arrival{d, seconds(arrival - hostOrigin_) - d};
  };
  if (contradicts(since())) {
    restart();
    begin(device, arrival);
  }
  add(since());
  fit();
  lastDevice_ = device;
  const auto correction = static_cast<std::int64_t>(std::llround(predicted(since().device) * 1e9));
  const std::int64_t host = hostOrigin_ + (device - deviceOrigin_) + correction;
  lastHost_ = std::max(host, lastHost_ + kLeastStep);  // a better fit must not turn time back
  return lastHost_;
}

/// A frame cannot come before it was taken. That it comes late can happen; that all do means a clock was set.
bool ClockMap::contradicts(const Arrival& arrival) {
  if (quickest_.empty()) return false;
  const double excess = arrival.delay - predicted(arrival.device);
  if (excess < -kLost) return true;
  late_ = excess > kLost ? late_ + 1 : 0;
  return late_ >= kPatience;
}

void ClockMap::add(const Arrival& arrival) {
  const auto bucket = [](const Arrival& a) { return std::floor(a.device / kBucket); };
  if (quickest_.empty() || bucket(quickest_.back()) < bucket(arrival)) {
    quickest_.push_back(arrival);
  } else if (arrival.delay < quickest_.back().delay) {
    quickest_.back() = arrival;
  } else {
    return;
  }
  while (quickest_.front().device < arrival.device - kWindow) quickest_.pop_front();
}

void ClockMap::fit() {
  const auto least = std::min_element(quickest_.begin(), quickest_.end(),
                                      [](const auto& a, const auto& b) { return a.delay < b.delay; });
  drift_ = 0.0;
  offset_ = least->delay;
  if (quickest_.back().device - quickest_.front().device < kSpanForDrift) return;

  std::vector<Arrival> hull;  // lower convex hull, left to right
  double mean = 0.0;
  for (const Arrival& a : quickest_) {
    mean += a.device / static_cast<double>(quickest_.size());
    const auto above = [&a](const Arrival& p, const Arrival& q) {
      return (q.delay - p.delay) * (a.device - p.device) >= (a.delay - p.delay) * (q.device - p.device);
    };
    while (hull.size() >= 2 && above(hull[hull.size() - 2], hull.back())) hull.pop_back();
    hull.push_back(a);
  }
  std::size_t right = 1;
  while (right + 1 < hull.size() && hull[right].device < mean) ++right;
  const Arrival &p = hull[right - 1], &q = hull[right];
  drift_ = std::clamp((q.delay - p.delay) / (q.device - p.device), -kMaxDrift, kMaxDrift);
  offset_ = p.delay - drift_ * p.device;
}

}  // namespace engram::capture

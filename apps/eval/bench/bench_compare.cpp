// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_compare.h"

#include "engram/base/error.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace engram::apps {
namespace {

using Times = std::vector<double>;

constexpr double kLeastChange = 0.06;  // [log] what is less is laid to the layout of the program in memory
constexpr double kLeastTime = 0.1;     // [ms] a clock tells nothing of steps that are shorter
constexpr double kHalfOf99 = 2.576;    // standard deviations

double medianMs(Times values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Times logRatios(const Times& before, const Times& after) {
  Times ratios(before.size());
  for (std::size_t i = 0; i < ratios.size(); ++i)
    ratios[i] = std::log(std::max(after[i], 1e-6) / std::max(before[i], 1e-6));
  return ratios;
}

/// Standard error of the median, from the median of the deviations.
double errorOf(Times ratios, double median) {
  for (double& r : ratios) r = std::abs(r - median);
  return 1.2533 * 1.4826 * medianMs(ratios) / std::sqrt(static_cast<double>(ratios.size()));
}

SpeedChange changeOf(const Times& before, const Times& after, double drift) {
  const Times ratios = logRatios(before, after);
  const double median = medianMs(ratios);
  SpeedChange change;
  change.before = medianMs(before);
  change.after = medianMs(after) / std::exp(drift);
  change.ratio = std::exp(median - drift);
  change.noise = kHalfOf99 * errorOf(ratios, median);
  return change;
}

const nlohmann::json& eachOf(const nlohmann::json& run) {
  const auto at = run.find("each_ms");
  if (at == run.end())
    throw base::Error("the figures to compare with hold no times of single images ('each_ms')");
  return *at;
}

Times imageTimes(const nlohmann::json& group, const std::string& what, std::size_t images) {
  Times times = group.at(what).get<Times>();
  if (times.size() != images || images == 0)
    throw base::Error("the figures to compare with are of " + std::to_string(times.size()) + " images of '" +
                      what + "', not of " + std::to_string(images) + ": give [bench] the values of then");
  return times;
}

std::string percentOf(double ratio) {
  std::ostringstream text;
  text << std::showpos << std::fixed << std::setprecision(1) << 100 * (ratio - 1) << " %";
  return text.str();
}

}  // namespace

bool SpeedChange::slower() const {
  return std::min(before, after) > kLeastTime && std::log(ratio) - noise > kLeastChange;
}

bool SpeedChange::faster() const {
  return std::min(before, after) > kLeastTime && std::log(ratio) + noise < -kLeastChange;
}

std::vector<SpeedChange> compareSpeed(const nlohmann::json& before, const nlohmann::json& after) {
  std::vector<SpeedChange> changes;
  for (const auto& [places, now] : eachOf(after).items()) {
    const auto then = eachOf(before).find(places);
    if (then == eachOf(before).end()) continue;
    const Times reference = now.at("reference").get<Times>();
    const double drift = medianMs(logRatios(imageTimes(*then, "reference", reference.size()), reference));
    for (const auto& [what, times] : now.items()) {
      if (what == "reference" || !then->contains(what)) continue;
      const Times mine = times.get<Times>();
      SpeedChange& change = changes.emplace_back(changeOf(imageTimes(*then, what, mine.size()), mine, drift));
      change.places = places;
      change.what = what;
    }
  }
  if (changes.empty()) throw base::Error("the figures to compare with are of maps of other sizes");
  return changes;
}

std::string describe(const std::vector<SpeedChange>& changes) {
  std::ostringstream out;
  for (const SpeedChange& c : changes) {
    if (!c.slower() && !c.faster()) continue;
    out << (c.slower() ? "slower: " : "faster: ") << c.what << " at " << c.places << " places, " << std::fixed
        << std::setprecision(2) << c.before << " to " << c.after << " ms (" << percentOf(c.ratio)
        << ", noise " << std::setprecision(1) << 100 * c.noise << " %)\n";
  }
  const std::string text = out.str();
  return text.empty() ? "nothing is slower or faster beyond noise\n" : text;
}

}  // namespace engram::apps

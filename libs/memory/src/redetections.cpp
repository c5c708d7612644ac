// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/redetections.h"

#include "edit.h"

#include <algorithm>
#include <vector>

namespace engram::memory {
namespace {

using Count = Redetections::Count;

constexpr double kPriorViews = 30;         // weight of the prior threshold
constexpr std::uint64_t kFewTrials = 100;  // below it a hazard says little: 0.05 +- 0.02 at best
constexpr std::uint64_t kMostTrials = std::uint64_t{1} << 56;

void add(Count& count, bool hit) {
  ++count.trials;
  count.hits += hit;
}

}  // namespace

void observe(Redetections& seen, const PlaceMemory& memory, std::span<const types::Match> matches) {
  std::vector<bool> hit(memory.states.size());
  for (const auto& match : matches) hit[static_cast<std::size_t>(match.b)] = true;
  const auto fsh = normalisedFsh(memory);
  for (std::size_t i = 0; i < hit.size(); ++i) {
    const int bin = static_cast<int>(fsh[i] * Redetections::kValueBins);
    add(seen.byValue[static_cast<std::size_t>(std::clamp(bin, 0, Redetections::kValueBins - 1))], hit[i]);
    const auto& state = memory.states[i];
    if (state.counter == 0 && state.age < Redetections::kAges) add(seen.byAge[state.age], hit[i]);
  }
  ++seen.views;
}

double learntThreshold(const Redetections& seen, double prior) {
  std::uint64_t allHits = 0;
  for (const Count& count : seen.byValue) allHits += count.hits;
  if (allHits == 0) return prior;
  // Above a threshold at the lower edge of bin b: all bins from b on. F1 = 2 TP / (positives + hits).
  double best = -1;
  int first = 0, last = 0;
  std::uint64_t trials = 0, hits = 0;
  for (int b = Redetections::kValueBins - 1; b >= 0; --b) {
    const Count& count = seen.byValue[static_cast<std::size_t>(b)];
    trials += count.trials;
    hits += count.hits;
    const double f1 = 2.0 * static_cast<double>(hits) / static_cast<double>(trials + allHits);
    if (f1 > best) {
      best = f1;
      first = last = b;
    } else if (count.trials == 0 && first == b + 1) {
      first = b;  // an empty bin: the same features are above
    }
  }
  const double learnt = 0.5 * (first + last) / Redetections::kValueBins;
  const double weight = static_cast<double>(seen.views) / (static_cast<double>(seen.views) + kPriorViews);
  return weight * learnt + (1 - weight) * prior;
}

std::optional<double> laterRedetection(const Redetections& seen, int age) {
  if (age < 0 || age > Redetections::kOldestForgetting) return std::nullopt;
  double never = 1;
  for (int n = age; n < age + Redetections::kHorizon; ++n) {
    const Count& count = seen.byAge[static_cast<std::size_t>(n)];
    if (count.trials < kFewTrials) return std::nullopt;
    never *= 1 - static_cast<double>(count.hits) / static_cast<double>(count.trials);
  }
  return 1 - never;
}

int learntForgettingAge(const Redetections& seen, int fallback, double chance) {
  for (int age = 1; age <= Redetections::kOldestForgetting; ++age) {
    const auto later = laterRedetection(seen, age);
    if (!later) return std::max(fallback, age);
    if (*later < chance) return age;
  }
  return Redetections::kOldestForgetting;
}

std::string brokenRule(const Redetections& seen) {
  const auto impossible = [](const Count& count) { return count.hits > count.trials; };
  // So many views take longer than the world has; the next one must not make the count overflow.
  const auto tooLarge = [](const Count& count) { return count.trials > kMostTrials; };
  if (seen.views > kMostTrials || std::ranges::any_of(seen.byValue, tooLarge) ||
      std::ranges::any_of(seen.byAge, tooLarge))
    return "its counts of features seen again are out of range";
  if (std::ranges::any_of(seen.byValue, impossible) || std::ranges::any_of(seen.byAge, impossible))
    return "its features were seen again more often than they were looked for";
  return {};
}

}  // namespace engram::memory

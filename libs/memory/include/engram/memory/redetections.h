// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"
#include "engram/types/match.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace engram::memory {

/// How often the remembered features of a map were seen again, over all of its places: what the long-term
/// threshold and the forgetting age of the FSH can be learnt from (F-31, D-12). Plain data, kept in the map.
struct Redetections {
  static constexpr int kValueBins = 64;
  static constexpr int kOldestForgetting = 16;  ///< bound of learntForgettingAge()
  static constexpr int kHorizon = 4;            ///< updates that a forgotten feature might have come back in
  static constexpr int kAges = kOldestForgetting + kHorizon;

  /// A remembered feature and a verified view of its place are one trial; a match makes it a hit.
  struct Count {
    std::uint64_t trials = 0, hits = 0;
    bool operator==(const Count&) const = default;
  };

  std::uint64_t views = 0;  ///< verified views counted
  /// By the normalised FSH before the view: bin b holds [b, b + 1) / kValueBins, the last one also 1.
  std::array<Count, kValueBins> byValue{};
  /// Of features never seen again before: [n - 1] counts their n-th chance. So hits / trials is the hazard of
  /// the age at which a feature is first seen again.
  std::array<Count, kAges> byAge{};

  bool operator==(const Redetections&) const = default;
};

/// Counts one verified view, before the memory learns from it. `memory` must be one of the FSH: there
/// FeatureState::counter says how often a feature was seen again.
/// @param matches one-to-one: b = feature of `memory`.
void observe(Redetections& seen, const PlaceMemory& memory, std::span<const types::Match> matches);

/// The normalised FSH value t for which "at least t" agrees best, by the F1 measure, with "will be seen
/// again in the next verified view". The middle where several values are equally good. Drawn towards `prior`
/// while there is little evidence: the prior weighs as much as 30 views.
double learntThreshold(const Redetections& seen, double prior);

/// Kaplan-Meier estimate of the chance that a feature not seen again in its first `age` chances is seen again
/// within the next kHorizon: 1 - prod(1 - h_n), n = age + 1 .. age + kHorizon. Features that were pruned or
/// whose place had no further view are censored: they count up to there. Nothing where one of the ages had
/// fewer than 100 trials.
std::optional<double> laterRedetection(const Redetections& seen, int age);

/// The smallest age, 1 to 16, from which laterRedetection() is below `chance`. Where the evidence ends before
/// one is found, `fallback`, or the first age that the evidence does not speak against, if that is later.
int learntForgettingAge(const Redetections& seen, int fallback, double chance);

/// The broken rule of counts that cannot be, in words; empty when all is well.
std::string brokenRule(const Redetections& seen);

}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/fsh.h"

#include "checks.h"
#include "edit.h"
#include "engram/base/error.h"
#include "settle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace engram::memory {
namespace {

using types::Features;
using types::Match;
using types::MemoryChange;

float largestValue(const PlaceMemory& memory) {
  float largest = 0;
  for (const auto& state : memory.states) largest = std::max(largest, state.value);
  return largest;
}

void decayAll(PlaceMemory& memory, double decay) {
  for (auto& state : memory.states) state.value = static_cast<float>(state.value * decay);
}

/// F eq (2). Every matched feature is rehearsed, not only those in long-term memory (F-E3).
void rehearse(PlaceMemory& memory, const Features& view, std::span<const Match> matches,
              const FshParams& params) {
  const auto votes = rehearsalVotes(matches, params);
  for (std::size_t k = 0; k < matches.size(); ++k) {
    const auto b = static_cast<std::size_t>(matches[k].b);
    auto& state = memory.states[b];
    state.value = static_cast<float>(state.value + votes[k]);
    if (state.counter < std::numeric_limits<std::uint16_t>::max()) ++state.counter;
    if (params.keep_descriptor == "newest") {
      // Only the descriptor: keypoint and bearing stay those of the view that made the feature.
      const auto row = view.descriptors.row(static_cast<std::size_t>(matches[k].a));
      std::copy(row.begin(), row.end(), memory.features.descriptors.mutableRow(b));
    }
  }
}

/// Responses have a heavy tail: by their norm a handful of features have votes near 1 and all others next to
/// none. By rank they are spread evenly, whatever the tail (F-E8, F-E10).
std::vector<double> votesByRank(std::span<const types::Keypoint> keypoints, double vote) {
  std::vector<float> sorted;
  for (const auto& keypoint : keypoints) sorted.push_back(std::abs(keypoint.response));
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> votes;
  for (const auto& keypoint : keypoints) {
    const auto above = std::upper_bound(sorted.begin(), sorted.end(), std::abs(keypoint.response));
    votes.push_back(vote * static_cast<double>(above - sorted.begin()) / static_cast<double>(sorted.size()));
  }
  return votes;
}

/// F eq (3), F-E4.
int insertNew(PlaceMemory& memory, const Features& stored, std::span<const Match> matches,
              const FshParams& params) {
  const auto votes = insertionVotes(stored.keypoints, params);
  return insertUnmatched(memory, stored, matches, params.duplicate_distance, [&](std::size_t i) {
    FeatureState state;
    state.value = static_cast<float>(votes[i]);
    return state;
  });
}

/// F eq (4) on raw votes, with the age of each feature (F-E5). In units of the nominal vote v the bound is
/// 1/max, that is v^2/max in votes. Where max < 1 it would exceed every value; so it never reaches into what
/// the threshold makes long-term (F-E6). Long-term features are never pruned, and by their floor the place
/// never empties.
void markPruned(const PlaceMemory& memory, const FshParams& params, std::vector<bool>& keep) {
  const double largest = largestValue(memory);
  if (largest <= 0) return;
  const double bound = std::min(params.vote * params.vote / largest, params.ltm_threshold * largest);
  for (std::size_t i = 0; i < memory.states.size(); ++i) {
    const auto& state = memory.states[i];
    if (state.stage == Stage::kShortTerm && state.age >= params.prune_view && state.value < bound)
      keep[i] = false;
  }
}

/// The cap. Short-term features go first, those with the fewest votes per update since they came; of equal
/// ones the oldest. By the bare value a full memory would admit nothing new; by age first, the clutter of one
/// crowded view would drive out what is on its way to long-term memory.
void markExcess(const PlaceMemory& memory, const FshParams& params, std::vector<bool>& keep) {
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) left.push_back(i);
  if (left.size() <= static_cast<std::size_t>(params.max_features)) return;
  const auto rate = [](const FeatureState& s) { return static_cast<double>(s.value) / (1.0 + s.age); };
  const auto goesFirst = [&](std::size_t i, std::size_t j) {
    const auto &a = memory.states[i], &b = memory.states[j];
    if (a.stage != b.stage) return a.stage == Stage::kShortTerm;
    if (a.stage == Stage::kLongTerm && a.value != b.value) return a.value < b.value;
    return rate(a) != rate(b) ? rate(a) < rate(b) : a.id < b.id;
  };
  std::sort(left.begin(), left.end(), goesFirst);
  left.resize(left.size() - static_cast<std::size_t>(params.max_features));
  for (const std::size_t i : left) keep[i] = false;
}

int prune(PlaceMemory& memory, const FshParams& params) {
  std::vector<bool> keep(memory.states.size(), true);
  markPruned(memory, params, keep);
  markExcess(memory, params, keep);
  return keepOnly(memory, keep);
}

/// F-15 with the floor of F-E10: the threshold is lowered to the value of the K-th best feature where it must
/// be. Features equal to that one are long-term too, so that the result does not depend on their order.
void classify(PlaceMemory& memory, const std::vector<float>& fsh, const FshParams& params,
              MemoryChange& change) {
  auto threshold = static_cast<float>(params.ltm_threshold);
  const auto floorSize = static_cast<std::size_t>(params.ltm_min_features);
  if (fsh.size() <= floorSize) {
    threshold = 0;
  } else if (floorSize > 0) {
    auto sorted = fsh;
    const auto kth = sorted.begin() + static_cast<std::ptrdiff_t>(floorSize) - 1;
    std::nth_element(sorted.begin(), kth, sorted.end(), std::greater<>());
    threshold = std::min(threshold, *kth);
  }
  change.longTerm = change.shortTerm = 0;
  for (std::size_t i = 0; i < fsh.size(); ++i) {
    auto& stage = memory.states[i].stage;
    const Stage now = fsh[i] >= threshold ? Stage::kLongTerm : Stage::kShortTerm;
    change.promoted += stage == Stage::kShortTerm && now == Stage::kLongTerm;
    change.demoted += stage == Stage::kLongTerm && now == Stage::kShortTerm;
    stage = now;
    ++(now == Stage::kLongTerm ? change.longTerm : change.shortTerm);
  }
}

/// rfsh of F-04.
void record(PlaceMemory& memory, const std::vector<float>& fsh, int length) {
  for (std::size_t i = 0; i < fsh.size(); ++i) {
    auto& history = memory.states[i].history;
    history.push_back(static_cast<std::uint8_t>(std::lround(255.0f * fsh[i])));
    const auto excess = static_cast<std::ptrdiff_t>(history.size()) - length;
    if (excess > 0) history.erase(history.begin(), history.begin() + excess);
  }
}

}  // namespace

void settle(PlaceMemory& memory, const FshParams& params, MemoryChange& change) {
  change.pruned = prune(memory, params);
  const auto fsh = normalisedFsh(memory);
  classify(memory, fsh, params, change);
  record(memory, fsh, params.history_length);
}

namespace {

MemoryChange updateBy(const FshParams& params, PlaceMemory& memory, const Features& view,
                      std::span<const Match> matches) {
  const Features stored = asStored(view);
  MemoryChange change;
  ageAll(memory);
  decayAll(memory, params.decay);
  rehearse(memory, stored, matches, params);
  change.rehearsed = static_cast<int>(matches.size());
  change.added = insertNew(memory, stored, matches, params);
  settle(memory, params, change);
  return change;
}

}  // namespace

void FshParams::describe(base::Params& p) {
  p.add("vote", vote, "nominal vote v of F eq (2), (3)", {1e-3, 1e3});
  p.add("ltm_threshold", ltm_threshold, "normalised FSH value from which a feature is long-term", {0, 1});
  p.add("prune_view", prune_view, "updates a feature is given before it can be pruned", {1, 1000});
  p.addChoice("vote_variance", vote_variance, "sigma_m^2 of F eq (2), see F-E7",
              {"second_moment", "literal", "fixed"});
  p.add("fixed_sigma", fixed_sigma, "sigma_m for vote_variance = fixed [descriptor distance]", {1e-6, 10});
  p.addChoice(
      "new_vote", new_vote,
      "norm that divides the response of a new feature, F eq (3); rank: the share of the features of the "
      "image that are no stronger takes the place of both",
      {"max", "l2", "rank"});
  p.add("ltm_min_features", ltm_min_features,
        "at least so many features are long-term, where there are so many", {1, 100000});
  p.add("max_features", max_features, "cap on the features of a place", {1, 100000});
  p.addChoice("keep_descriptor", keep_descriptor, "descriptor of a re-observed feature", {"old", "newest"});
  p.add("history_length", history_length, "FSH values kept for each feature", {0, 10000});
  p.add("duplicate_distance", duplicate_distance,
        "a new feature nearer than this to a known one is not inserted; 0 inserts all [descriptor distance]",
        {0, 2});
  p.addChoice("thresholds", thresholds,
              "ltm_threshold and prune_view as given, or learnt from how often features were seen again",
              {"fixed", "learned"});
  p.add("forget_chance", forget_chance,
        "thresholds = learned: a feature is given no more updates once the chance of seeing it again in the "
        "next four is below this",
        {0, 1});
  p.add("decay", decay, "factor on all votes before each update; 1 never forgets, as the paper", {0.5, 1});
}

std::vector<double> rehearsalVotes(std::span<const Match> matches, const FshParams& params) {
  double sum = 0, squares = 0;
  for (const auto& match : matches) {
    sum += match.distance;
    squares += static_cast<double>(match.distance) * match.distance;
  }
  const double n = std::max<double>(1, static_cast<double>(matches.size()));
  const double moment = squares / n;
  double variance = moment;
  if (params.vote_variance == "fixed") variance = params.fixed_sigma * params.fixed_sigma;
  if (params.vote_variance == "literal") {
    variance = 0;
    for (const auto& match : matches) variance += (match.distance - sum / n) * (match.distance - sum / n) / n;
    // One match, or all equal: the variance says nothing (F-E7).
    if (variance < 1e-12) variance = moment;
  }
  std::vector<double> votes;
  votes.reserve(matches.size());
  for (const auto& match : matches) {
    const double squared = static_cast<double>(match.distance) * match.distance;
    votes.push_back(variance > 0 ? params.vote * std::exp(-squared / variance) : params.vote);
  }
  return votes;
}

std::vector<double> insertionVotes(std::span<const types::Keypoint> keypoints, const FshParams& params) {
  if (params.new_vote == "rank") return votesByRank(keypoints, params.vote);
  double largest = 0, squares = 0;
  for (const auto& keypoint : keypoints) {
    const double response = std::abs(static_cast<double>(keypoint.response));
    largest = std::max(largest, response);
    squares += response * response;
  }
  const double norm = params.new_vote == "l2" ? std::sqrt(squares) : largest;
  std::vector<double> votes;
  votes.reserve(keypoints.size());
  for (const auto& keypoint : keypoints) {
    const double response = std::abs(static_cast<double>(keypoint.response));
    // A detector without responses: all are equally strong.
    votes.push_back(norm > 0 ? params.vote * response / norm : params.vote);
  }
  return votes;
}

Fsh::Fsh(FshParams params) : params_(std::move(params)) {
  base::validate(params_);
  if (params_.ltm_min_features > params_.max_features)
    throw base::ConfigError("[fsh] ltm_min_features = " + std::to_string(params_.ltm_min_features) +
                            " must not exceed max_features = " + std::to_string(params_.max_features));
}

PlaceMemory Fsh::start(const Features& view) const {
  checkView(view);
  PlaceMemory memory = emptyMemory(view);
  MemoryChange change;
  insertNew(memory, asStored(view), {}, params_);
  memory.updates = 1;
  settle(memory, params_, change);
  return memory;
}

MemoryChange Fsh::update(PlaceMemory& memory, const Features& view, std::span<const Match> matches) const {
  checkUpdate(memory, view, matches);
  return updateBy(params_, memory, view, matches);
}

MemoryChange Fsh::learn(PlaceMemory& memory, const Features& view, std::span<const Match> matches,
                        Redetections& seen) const {
  checkUpdate(memory, view, matches);
  observe(seen, memory, matches);
  return updateBy(paramsInForce(params_, seen), memory, view, matches);
}

FshParams paramsInForce(FshParams params, const Redetections& seen) {
  if (params.thresholds == "fixed") return params;
  params.ltm_threshold = learntThreshold(seen, params.ltm_threshold);
  params.prune_view = learntForgettingAge(seen, params.prune_view, params.forget_chance);
  return params;
}

}  // namespace engram::memory

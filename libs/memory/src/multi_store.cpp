// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/multi_store.h"

#include "checks.h"
#include "edit.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace engram::memory {
namespace {

constexpr std::uint16_t kFirst = 1;
constexpr std::uint16_t kGone = 0;  // no state is 0: a feature to be removed

FeatureState seenOnce(Stage stage) {
  FeatureState state;
  state.value = 1;
  state.counter = kFirst;
  state.stage = stage;
  return state;
}

std::uint16_t next(std::uint16_t counter) {
  return counter < std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(counter + 1)
                                                             : counter;
}

/// D-04 for one feature. Whether a last state means out is decided for all together, by forgetLongTerm().
void recall(FeatureState& state, bool hit) { state.counter = hit ? kFirst : next(state.counter); }

/// D-05 for one feature.
void rehearse(FeatureState& state, bool hit, const MultiStoreParams& params) {
  if (!hit) {
    state.counter = state.counter <= kFirst ? kGone : kFirst;
    return;
  }
  state.counter = next(state.counter);
  if (state.counter <= params.stm_states) return;
  state.stage = Stage::kLongTerm;
  state.counter = kFirst;
}

/// Marks the long-term features that have run out of states, but leaves the floor (D-E6). The order is by
/// what a feature is, never by its index or its id.
void forgetLongTerm(const PlaceMemory& memory, const MultiStoreParams& params, std::vector<bool>& keep) {
  std::vector<std::size_t> spent;
  std::size_t longTerm = 0;
  for (std::size_t i = 0; i < memory.states.size(); ++i) {
    if (memory.states[i].stage != Stage::kLongTerm) continue;
    ++longTerm;
    if (memory.states[i].counter > params.ltm_states) spent.push_back(i);
  }
  const auto floorSize = static_cast<std::size_t>(params.ltm_min_features);
  const std::size_t excess = longTerm > floorSize ? longTerm - floorSize : 0;
  const auto rank = [&](std::size_t i) {
    const auto& s = memory.states[i];
    const auto& k = memory.features.keypoints[i];
    return std::tuple(-static_cast<int>(s.counter), s.value, k.response, k.size, k.x, k.y, k.angle);
  };
  std::sort(spent.begin(), spent.end(), [&](std::size_t i, std::size_t j) {
    const auto a = rank(i), b = rank(j);
    if (a != b) return a < b;
    return std::ranges::lexicographical_compare(memory.features.descriptors.row(i),
                                                memory.features.descriptors.row(j));
  });
  spent.resize(std::min(spent.size(), excess));
  for (const std::size_t i : spent) keep[i] = false;
}

void count(const PlaceMemory& memory, types::MemoryChange& change) {
  change.longTerm = static_cast<int>(memory.longTerm().size());
  change.shortTerm = static_cast<int>(memory.states.size()) - change.longTerm;
}

}  // namespace

void MultiStoreParams::describe(base::Params& p) {
  p.add("stm_states", stm_states, "states of a short-term feature; one sighting more promotes it", {1, 1000});
  p.add("ltm_states", ltm_states, "so many misses in a row make a long-term feature forgotten", {1, 1000});
  p.add("ltm_min_features", ltm_min_features, "the long-term memory does not shrink below so many features",
        {1, 100000});
  p.add("duplicate_distance", duplicate_distance,
        "a new feature nearer than this to a known one is not inserted; 0 inserts all [descriptor distance]",
        {0, 2});
}

MultiStore::MultiStore(MultiStoreParams params) : params_(params) { base::validate(params_); }

PlaceMemory MultiStore::start(const types::Features& view) const {
  checkView(view);
  PlaceMemory memory = emptyMemory(view);
  insertUnmatched(memory, asStored(view), {}, params_.duplicate_distance,
                  [](std::size_t) { return seenOnce(Stage::kLongTerm); });
  memory.updates = 1;
  return memory;
}

types::MemoryChange MultiStore::update(PlaceMemory& memory, const types::Features& view,
                                       std::span<const types::Match> matches) const {
  checkUpdate(memory, view, matches);
  types::MemoryChange change;
  change.rehearsed = static_cast<int>(matches.size());
  const bool wasEmpty = memory.features.empty();
  ageAll(memory);
  std::vector<bool> hit(memory.states.size());
  for (const auto& match : matches) hit[static_cast<std::size_t>(match.b)] = true;
  for (std::size_t i = 0; i < hit.size(); ++i) {
    FeatureState& state = memory.states[i];
    if (hit[i]) state.value += 1;
    if (state.stage == Stage::kLongTerm) {
      recall(state, hit[i]);
    } else {
      rehearse(state, hit[i], params_);
      change.promoted += state.stage == Stage::kLongTerm;
    }
  }
  std::vector<bool> keep;
  for (const FeatureState& state : memory.states) keep.push_back(state.counter != kGone);
  forgetLongTerm(memory, params_, keep);
  change.pruned = keepOnly(memory, keep);
  change.added =
      insertUnmatched(memory, asStored(view), matches, params_.duplicate_distance,
                      [&](std::size_t) { return seenOnce(wasEmpty ? Stage::kLongTerm : Stage::kShortTerm); });
  count(memory, change);
  return change;
}

}  // namespace engram::memory

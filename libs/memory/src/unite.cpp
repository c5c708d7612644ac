// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/unite.h"

#include "checks.h"
#include "edit.h"
#include "settle.h"

#include <algorithm>
#include <limits>
#include <set>

namespace engram::memory {
namespace {

/// How a feature that both remember is remembered, and what one of b alone becomes.
struct Law {
  std::function<FeatureState(const FeatureState&, const FeatureState&)> both;
  double duplicateDistance = 0;
};

std::uint16_t added(int a, int b) {
  return static_cast<std::uint16_t>(std::min<int>(a + b, std::numeric_limits<std::uint16_t>::max()));
}

FeatureState bothVoted(const FeatureState& a, const FeatureState& b) {
  FeatureState s = a;
  s.value = a.value + b.value;
  s.age = std::max(a.age, b.age);
  s.counter = added(a.counter, b.counter + 1);
  if (a.stage == Stage::kLongTerm || b.stage == Stage::kLongTerm) s.stage = Stage::kLongTerm;
  return s;
}

FeatureState bothStored(const FeatureState& a, const FeatureState& b, const MultiStoreParams& params) {
  FeatureState s = a;
  s.value = a.value + b.value;
  s.age = std::max(a.age, b.age);
  const bool longA = a.stage == Stage::kLongTerm, longB = b.stage == Stage::kLongTerm;
  if (longA && longB) s.counter = std::min(a.counter, b.counter);
  if (longA != longB) s.counter = longA ? a.counter : b.counter;
  if (longA || longB) {
    s.stage = Stage::kLongTerm;
    return s;
  }
  s.counter = added(a.counter, b.counter);
  if (s.counter <= params.stm_states) return s;
  s.stage = Stage::kLongTerm;
  s.counter = 1;
  return s;
}

United joinedBy(const PlaceMemory& a, const PlaceMemory& b, std::span<const types::Match> matches,
                const Law& law) {
  United u{a, {}, {}};
  u.memory.updates = a.updates + b.updates;
  for (const types::Match& m : matches) {
    FeatureState& state = u.memory.states[static_cast<std::size_t>(m.b)];
    const FeatureState& other = b.states[static_cast<std::size_t>(m.a)];
    state = law.both(state, other);
    u.idOfB[other.id] = state.id;
  }
  std::vector<std::size_t> came;
  insertUnmatched(u.memory, b.features, matches, law.duplicateDistance, [&](std::size_t i) {
    came.push_back(i);
    return b.states[i];
  });
  const std::size_t first = u.memory.states.size() - came.size();
  for (std::size_t k = 0; k < came.size(); ++k) u.idOfB[b.states[came[k]].id] = u.memory.states[first + k].id;
  for (const FeatureState& state : a.states) u.idOfA[state.id] = state.id;
  return u;
}

/// Numbers of features that the united memory has let go lead nowhere.
void dropGone(United& u) {
  std::set<std::uint32_t> kept;
  for (const FeatureState& state : u.memory.states) kept.insert(state.id);
  for (auto* ids : {&u.idOfA, &u.idOfB})
    std::erase_if(*ids, [&](const auto& item) { return !kept.contains(item.second); });
}

United alone(const PlaceMemory& memory, bool isB) {
  United u{memory, {}, {}};
  for (const FeatureState& state : memory.states) (isB ? u.idOfB : u.idOfA)[state.id] = state.id;
  return u;
}

void addCounts(Redetections::Count& to, const Redetections::Count& from) {
  to.trials += from.trials;
  to.hits += from.hits;
}

}  // namespace

United unite(const PlaceMemory& a, const PlaceMemory& b, std::span<const types::Match> matches,
             const MemoryParams& params, const FshParams& fsh, const MultiStoreParams& multiStore) {
  checkUpdate(a, b.features, matches);
  if (params.memory == "static") return alone(a, false);
  if (params.memory == "replace") return alone(b, true);
  if (params.memory == "multi_store")
    return joinedBy(a, b, matches,
                    {[&](const auto& x, const auto& y) { return bothStored(x, y, multiStore); },
                     multiStore.duplicate_distance});
  United u = joinedBy(a, b, matches, {bothVoted, fsh.duplicate_distance});
  types::MemoryChange change;
  settle(u.memory, fsh, change);
  dropGone(u);
  return u;
}

Redetections sum(const Redetections& a, const Redetections& b) {
  Redetections s = a;
  s.views += b.views;
  for (std::size_t i = 0; i < s.byValue.size(); ++i) addCounts(s.byValue[i], b.byValue[i]);
  for (std::size_t i = 0; i < s.byAge.size(); ++i) addCounts(s.byAge[i], b.byAge[i]);
  return s;
}

}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "edit.h"

#include "near_duplicates.h"

#include <algorithm>
#include <limits>

namespace engram::memory {

types::Features asStored(const types::Features& view) {
  types::Features stored = view;
  stored.descriptors = types::quantised(view.descriptors);
  return stored;
}

PlaceMemory emptyMemory(const types::Features& view) {
  PlaceMemory memory;
  memory.features.descriptors =
      types::quantised(types::Descriptors(view.descriptors.kind(), view.descriptors.dim()));
  return memory;
}

int insertUnmatched(PlaceMemory& memory, const types::Features& stored, std::span<const types::Match> matches,
                    double duplicateDistance, const std::function<FeatureState(std::size_t)>& stateOf) {
  std::vector<bool> matched(stored.size());
  for (const auto& match : matches) matched[static_cast<std::size_t>(match.a)] = true;
  const types::Descriptors known = memory.features.descriptors;
  int added = 0;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (matched[i] || hasNearDuplicate(known, stored.descriptors, i, duplicateDistance)) continue;
    memory.features.append(stored, i);
    FeatureState state = stateOf(i);
    state.id = memory.nextFeatureId++;
    memory.states.push_back(std::move(state));
    ++added;
  }
  return added;
}

int keepOnly(PlaceMemory& memory, const std::vector<bool>& keep) {
  std::vector<int> kept;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) kept.push_back(static_cast<int>(i));
  const int removed = static_cast<int>(keep.size() - kept.size());
  if (removed == 0) return 0;
  std::vector<FeatureState> states;
  states.reserve(kept.size());
  for (const int i : kept) states.push_back(std::move(memory.states[static_cast<std::size_t>(i)]));
  memory.features = memory.features.subset(kept);
  memory.states = std::move(states);
  return removed;
}

std::vector<float> normalisedFsh(const PlaceMemory& memory) {
  float largest = 0;
  for (const auto& state : memory.states) largest = std::max(largest, state.value);
  std::vector<float> fsh;
  fsh.reserve(memory.states.size());
  for (const auto& state : memory.states) fsh.push_back(largest > 0 ? state.value / largest : 1.0f);
  return fsh;
}

void ageAll(PlaceMemory& memory) {
  for (auto& state : memory.states)
    if (state.age < std::numeric_limits<std::uint16_t>::max()) ++state.age;
  ++memory.updates;
}

}  // namespace engram::memory

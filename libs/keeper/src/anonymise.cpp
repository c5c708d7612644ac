// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/edits.h"
#include "engram/memory/place_memory.h"

#include <set>

namespace engram::keeper {
namespace {

std::size_t takeName(std::string& name) {
  if (name.empty()) return 0;
  name.clear();
  return 1;
}

std::size_t takeNames(store::WholeMap& map) {
  std::size_t taken = 0;
  for (auto& [id, place] : map.content.places) taken += takeName(place.createdLabel);
  for (auto& [id, view] : map.content.views) taken += takeName(view.label);
  for (types::FrameReport& report : map.records) taken += takeName(report.label);
  for (store::Drive& drive : map.drives) taken += takeName(drive.source);
  return taken;
}

/// A feature that came with one view, and that later views of the place did not show.
bool seenOnce(const memory::FeatureState& state) {
  return state.stage == memory::Stage::kShortTerm && state.age > 0 && state.counter <= 1;
}

std::size_t dropPassersBy(memory::PlaceMemory& memory) {
  std::vector<int> kept;
  std::vector<memory::FeatureState> states;
  for (std::size_t i = 0; i < memory.states.size(); ++i) {
    if (seenOnce(memory.states[i])) continue;
    kept.push_back(static_cast<int>(i));
    states.push_back(memory.states[i]);
  }
  const std::size_t dropped = memory.states.size() - kept.size();
  if (dropped == 0) return 0;
  memory.features = memory.features.subset(kept);
  memory.states = std::move(states);
  return dropped;
}

void dropForgotten(map::MapContent& content) {
  std::map<map::PlaceId, std::set<std::uint32_t>> known;
  for (const auto& [id, place] : content.places)
    for (const auto& state : place.memory->states) known[id].insert(state.id);
  for (auto& [id, edge] : content.edges)
    std::erase_if(edge.correspondences, [&, &e = edge](const auto& pair) {
      return !known[e.a].contains(pair.first) || !known[e.b].contains(pair.second);
    });
}

}  // namespace

Anonymised anonymise(store::WholeMap& map, bool keepNames) {
  Anonymised done;
  for (auto& [id, view] : map.content.views) {
    done.pictures += !view.jpeg.empty();
    view.jpeg.clear();
  }
  if (!keepNames) done.names = takeNames(map);
  for (auto& [id, place] : map.content.places) done.features += dropPassersBy(place.memory.edit());
  if (done.features > 0) dropForgotten(map.content);
  return done;
}

}  // namespace engram::keeper

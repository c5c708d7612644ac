// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/static_view.h"

#include "checks.h"
#include "edit.h"

namespace engram::memory {

PlaceMemory Static::start(const types::Features& view) const {
  checkView(view);
  PlaceMemory memory;
  memory.features = asStored(view);
  memory.states.resize(view.size());
  for (auto& state : memory.states) {
    state.id = memory.nextFeatureId++;
    state.value = 1;
    state.stage = Stage::kLongTerm;
  }
  memory.updates = 1;
  return memory;
}

types::MemoryChange Static::update(PlaceMemory& memory, const types::Features& view,
                                   std::span<const types::Match> matches) const {
  checkUpdate(memory, view, matches);
  types::MemoryChange change;
  change.longTerm = static_cast<int>(memory.states.size());
  return change;
}

}  // namespace engram::memory

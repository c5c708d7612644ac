// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replace.h"

#include "checks.h"
#include "engram/memory/static_view.h"

namespace engram::memory {

PlaceMemory Replace::start(const types::Features& view) const { return Static().start(view); }

types::MemoryChange Replace::update(PlaceMemory& memory, const types::Features& view,
                                    std::span<const types::Match> matches) const {
  checkUpdate(memory, view, matches);
  types::MemoryChange change;
  if (!view.empty()) {
    PlaceMemory latest = start(view);
    for (auto& state : latest.states) state.id += memory.nextFeatureId;
    latest.nextFeatureId += memory.nextFeatureId;
    latest.updates = memory.updates;
    change.pruned = static_cast<int>(memory.states.size());
    change.added = static_cast<int>(latest.states.size());
    memory = std::move(latest);
  }
  ++memory.updates;
  change.longTerm = static_cast<int>(memory.states.size());
  return change;
}

}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/static_view.h"

#include "checks.h"
#include "engram/base/error.h"

namespace engram::memory {

PlaceMemory Static::start(const types::Features& view) const {
  checkView(view);
  PlaceMemory memory;
  memory.features = view;
  memory.features.descriptors = types::quantised(view.descriptors);
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

void MemoryParams::describe(base::Params& p) {
  p.addChoice("memory", memory, "how a place remembers", {"fsh", "static"});
}

std::unique_ptr<MemoryModel> makeMemoryModel(const MemoryParams& params, const FshParams& fsh) {
  base::validate(params);
  if (params.memory == "static") return std::make_unique<Static>();
  return std::make_unique<Fsh>(fsh);
}

}  // namespace engram::memory

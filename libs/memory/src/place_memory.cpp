// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/place_memory.h"

namespace engram::memory {

std::vector<int> PlaceMemory::longTerm() const {
  std::vector<int> indices;
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i].stage == Stage::kLongTerm) indices.push_back(static_cast<int>(i));
  return indices;
}

types::MemoryChange MemoryModel::learn(PlaceMemory& memory, const types::Features& view,
                                       std::span<const types::Match> matches, Redetections&) const {
  return update(memory, view, matches);
}

}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"

namespace engram::memory {

/// The baseline: the first view of a place, all of it long-term, for ever.
class Static : public MemoryModel {
 public:
  PlaceMemory start(const types::Features& view) const override;
  /// Changes nothing. Checks its arguments as Fsh does.
  types::MemoryChange update(PlaceMemory& memory, const types::Features& view,
                             std::span<const types::Match> matches) const override;
};

}  // namespace engram::memory

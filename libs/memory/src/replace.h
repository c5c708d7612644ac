// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"

namespace engram::memory {

/// The naive baseline of D-13: the latest verified view is the reference, all of it long-term. What was
/// hidden in that view is lost.
class Replace : public MemoryModel {
 public:
  PlaceMemory start(const types::Features& view) const override;
  /// All features of the view come in with new ids, all old ones go. An empty view replaces nothing: the
  /// place could never be recognised again (D-E6). Checks its arguments as Fsh does.
  types::MemoryChange update(PlaceMemory& memory, const types::Features& view,
                             std::span<const types::Match> matches) const override;
};

}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"

namespace engram::memory {

/// Throws std::invalid_argument when an update with these arguments breaks the contract of
/// MemoryModel::update.
void checkUpdate(const PlaceMemory& memory, const types::Features& view,
                 std::span<const types::Match> matches);

/// Throws std::invalid_argument when the parallel arrays of a view differ in length or a response is not
/// finite.
void checkView(const types::Features& view);

}  // namespace engram::memory

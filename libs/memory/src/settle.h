// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/fsh.h"

namespace engram::memory {

/// What ends each update of the FSH (F-16): prune, normalise, classify.
void settle(PlaceMemory& memory, const FshParams& params, types::MemoryChange& change);

}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

namespace engram::memory {

/// Whether a row of `set` lies closer than `distance` to row i of `of`; both have one layout.
/// The distance is that of types::Match. 0 means never.
bool hasNearDuplicate(const types::Descriptors& set, const types::Descriptors& of, std::size_t i,
                      double distance);

}  // namespace engram::memory

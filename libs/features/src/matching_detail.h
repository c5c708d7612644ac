// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cpu.h"
#include "descriptor_blocks.h"
#include "engram/features/matching.h"

#include <vector>

namespace engram::features::detail {

/// match() on prepared sets, with a given instruction set.
/// @throws std::invalid_argument when kinds or dimensions differ.
std::vector<types::Match> matchPrepared(SimdLevel level, const PreparedSet& a, const PreparedSet& b,
                                        const MatchParams& params);

/// The same features with quantised descriptors; only what matching needs.
types::Features quantisedFeatures(const types::Features& features);

}  // namespace engram::features::detail

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <cstddef>

namespace engram::vocabulary {

/// Distances of one descriptor to all rows: squared L2 of the stored components (kFloat, kInt8) or numbers of
/// bits (kBinary). The same bits on every processor. `out` has room for rows.size().
void distancesTo(const std::byte* query, const types::Descriptors& rows, float* out);
/// The same to n rows from `first` on.
void distancesTo(const std::byte* query, const types::Descriptors& rows, std::size_t first, std::size_t n,
                 float* out);

/// What is nearest to all rows: the mean, rounded (kInt8), or the majority of each bit (kBinary).
/// `chosen` has a flag for each row; at least one is set.
void meanOf(const types::Descriptors& rows, const std::vector<std::uint8_t>& chosen, std::uint8_t flag,
            std::byte* out);

}  // namespace engram::vocabulary

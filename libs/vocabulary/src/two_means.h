// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <cstdint>
#include <vector>

namespace engram::vocabulary {

/// A set of descriptors in two clusters.
struct TwoMeans {
  std::vector<std::uint8_t> side;  ///< 0 or 1 for each row; each has at least a quarter of them
  types::Descriptors means;        ///< two rows
};

/// 2-means from two rows far apart. At least four rows. Deterministic.
TwoMeans twoMeans(const types::Descriptors& rows);

}  // namespace engram::vocabulary

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/types/features.h"

#include <cstdint>
#include <vector>

namespace engram::vocabulary {

/// Descriptors of any kind in at most 255 clusters.
struct Clustering {
  types::Descriptors centres;         ///< means, or majorities of the bits; none is empty
  std::vector<std::uint8_t> nearest;  ///< for each row the number of its centre (ties: the lower)
};

/// Lloyd's algorithm from a k-means++ start (Arthur & Vassilvitskii 2007). Fewer than k clusters where rows
/// are equal. At least one row.
Clustering kMeans(const types::Descriptors& rows, int k, int iterations, base::Rng rng);

}  // namespace engram::vocabulary

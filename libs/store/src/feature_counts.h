// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "connection.h"
#include "engram/store/feature_counts.h"

#include <cstdint>
#include <map>

namespace engram::store {

/// Of each place by its number: what it remembers, and the checksum of the row that says so.
struct PlaceCounts {
  std::uint32_t checksum = 0;
  std::uint32_t longTerm = 0, all = 0;
  bool operator==(const PlaceCounts&) const = default;
};
using CountsByPlace = std::map<std::uint32_t, PlaceCounts>;

/// What is kept beside a map of version 3, as it is.
CountsByPlace keptCounts(Connection& database);

/// The same as it holds good now; the rows of memories that have changed since are read. Throws
/// base::Error for one that is damaged.
/// @param version of the format of the map
CountsByPlace countFeatures(Connection& database, int version);

FeatureCounts sumOf(const CountsByPlace& counts);

/// Keeps them. To be called within a transaction.
void writeCounts(Connection& database, const CountsByPlace& counts);

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/models.h"

#include <map>
#include <span>

namespace engram::memory {

/// Two memories of one place as one, and what became of their features.
struct United {
  PlaceMemory memory;
  std::map<std::uint32_t, std::uint32_t> idOfA, idOfB;  ///< old number of a feature to its new one
};

/// Two robots have learnt one place apart: their memories become one by the laws of the memory.
///
/// `fsh`: votes add up, a feature keeps its age, and what both remember has been seen again once more; then
/// the histogram is divided, pruned and classified as after an update. `multi_store`: a feature is long-term
/// when either had it so, with the fewer misses; sightings of short-term ones add up and may promote.
/// `static`: that of a. `replace`: that of b.
/// Nothing is rehearsed: to unite is no view, so votes of a and b count once, in whichever order.
/// @param a the older memory. @param b its bearings are in the frame of a
/// @param matches verified and one-to-one: a = feature of b, b = feature of a
/// Throws std::invalid_argument as MemoryModel::update() does.
United unite(const PlaceMemory& a, const PlaceMemory& b, std::span<const types::Match> matches,
             const MemoryParams& params, const FshParams& fsh, const MultiStoreParams& multiStore);

/// The counts of two maps together.
Redetections sum(const Redetections& a, const Redetections& b);

}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/store/whole_map.h"

#include <functional>
#include <set>

namespace engram::keeper {

/// Takes places out and mends the graph around each, as upkeep does; one that no edge joins to another goes
/// without. Path points of theirs go where `keepPath` says no, else they are tied to the heirs.
void removePlaces(map::MapContent& content, const std::set<map::PlaceId>& gone, bool keepPath);

/// Records and path stay in step with the drives: drops the records that `goes` names, numbers the rest from
/// `firstRecord` on without gaps, and counts the images of each drive anew. Returns how many went.
std::size_t dropRecords(store::WholeMap& map, const std::function<bool(std::uint64_t number)>& goes);

/// Records name no place that has gone.
void forgetPlaces(std::vector<types::FrameReport>& records, const map::MapContent& content);

}  // namespace engram::keeper

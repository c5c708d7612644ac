// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/keeper/configuration.h"
#include "engram/posegraph/gating.h"
#include "engram/store/whole_map.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace engram::keeper {

/// Places that are not to be joined by a closure, the smaller number first.
using Rejections = std::set<std::pair<map::PlaceId, map::PlaceId>>;

/// Name of the note that holds them: a line "A B" for each.
inline constexpr const char* kRejectedNote = "rejected_closures";
Rejections rejectionsOf(const std::map<std::string, std::string>& notes);
void setRejections(store::WholeMap& map, const Rejections& rejections);

/// A closure of a map, examined again.
struct Closure {
  map::EdgeId id;
  map::EdgeType type = map::EdgeType::kLoop;
  map::PlaceId a, b;
  double distance = 0;  ///< from where the edge says b is to where the map has it [m]
  double angle = 0;     ///< [rad]
  double chi2 = 0;      ///< of the edge against the map as it stands
  int matches = 0;      ///< verified between what both places remember now; 0: they do not match any more
};

/// All loop and recognition edges, by number. Matching takes milliseconds each.
std::vector<Closure> closures(const store::WholeMap& map, const Configuration& configuration);

/// Takes closures out, lays down that their places are not the same ground, and relaxes. Throws base::Error
/// for an edge that is none.
void reject(store::WholeMap& map, std::span<const map::EdgeId> edges, const pipeline::PipelineParams& params);

/// What became of a closure that was asked for.
struct Added {
  bool accepted = false;
  map::EdgeId edge;
  int matches = 0;
  std::string reason;  ///< why not
};
/// Joins two places that show the same ground, if what they remember matches and the graph does not deny it:
/// the tests of mapping. A rejection of the pair is taken back when it is accepted.
Added addClosure(store::WholeMap& map, map::PlaceId a, map::PlaceId b, const Configuration& configuration);

}  // namespace engram::keeper

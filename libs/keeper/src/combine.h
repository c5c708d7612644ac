// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/store/whole_map.h"

#include <map>
#include <set>

namespace engram::keeper {

/// What two maps share because one was copied and both went on.
struct CommonPast {
  std::set<std::uint32_t> drives;  ///< numbers in b
  std::map<int, int> sessions;     ///< of their paths: number in b, number in a
  std::set<map::PlaceId> places;   ///< with the same number in both
};
CommonPast commonPast(const store::WholeMap& a, const store::WholeMap& b);

/// The numbers that things of b have in the map of both.
struct Numbering {
  std::map<map::PlaceId, map::PlaceId> places;
  std::uint32_t place = 0, view = 0, edge = 0;  ///< added to others
  int session = 0;                              ///< added to those that are not shared

  /// A place that b has, or had; invalid for an invalid one.
  map::PlaceId of(map::PlaceId id) const;
};

/// Puts b beside a, in one map with two frames made one: every row of b that a does not have is there under a
/// new number. @param T_a_b the frame of b, seen from that of a
Numbering combine(store::WholeMap& a, const store::WholeMap& b, const CommonPast& past,
                  const Eigen::Isometry3d& T_a_b);

}  // namespace engram::keeper

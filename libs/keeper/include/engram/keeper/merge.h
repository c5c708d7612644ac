// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/keeper/configuration.h"
#include "engram/store/whole_map.h"

#include <cstddef>
#include <functional>
#include <string>

namespace engram::keeper {

/// What became of a merge.
struct Merged {
  bool joined = false;
  std::string reason;        ///< why they were kept apart, in words; or that nothing was to be done
  std::size_t verified = 0;  ///< places of b that geometry recognised in a
  std::size_t agreeing = 0;  ///< of them, those that say the same of where b lies in a
  std::size_t closures = 0;  ///< joints that the tests of closures let in
  std::size_t united = 0;    ///< places of b that became one with a place of a
  std::size_t known = 0;     ///< places that both have from a common past
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();  ///< of the map frames, before relaxation
};

/// Two maps of one building become one, in `a`: its frame and numbers stay, those of b follow behind.
///
/// Each place of b is recognised in a by what it remembers: evidence proposes, geometry decides as for a
/// loop closure, and a rival elsewhere in a refuses it. At least three places must agree on where b lies, and
/// more than half of all that were verified, and a third of
/// those that would then lie beside places of a; then the tests of closures judge each joint over both graphs
/// together. Places that then lie within half a spacing, recognise each other and are the nearest to each
/// other become one: see memory::unite(). The whole graph is relaxed. When the maps are not joined, `a` stays
/// as it was.
///
/// A map whose drives are all in the other one brings nothing: a map merged with itself is itself. Places
/// that both have from a common past (one was copied and both went on) are one without recognition; the
/// memory that has learnt more stays.
/// Throws base::ConfigError when camera, extractor, descriptors or memory differ, base::Error for maps of
/// scans.
/// @param progress share of the places of b that are done
Merged merge(store::WholeMap& a, const store::WholeMap& b, const std::string& nameA, const std::string& nameB,
             const std::function<void(double)>& progress = {});

}  // namespace engram::keeper

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/store/whole_map.h"

#include <cstddef>
#include <string>
#include <vector>

namespace engram::keeper {

/// How two maps differ in things of one kind. Numbers name the same thing in both: so they do in copies of
/// one map that went on apart.
struct KindDifference {
  std::string kind;                                  ///< `places`, `memories`, `views`, …
  std::vector<std::uint64_t> onlyA, onlyB, changed;  ///< numbers, rising
  std::size_t equal = 0;
  bool same() const { return onlyA.empty() && onlyB.empty() && changed.empty(); }
};

struct Difference {
  std::vector<KindDifference> kinds;
  double movedMost = 0, movedMean = 0;  ///< of the places in both [m]
  std::vector<std::string> parameters;  ///< lines of header and configuration: "- old", "+ new"
  bool same() const;
};

/// Compares rows as the store writes them: equal means equal to the last bit.
Difference diff(const store::WholeMap& a, const store::WholeMap& b);

}  // namespace engram::keeper

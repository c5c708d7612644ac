// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/gating.h"

namespace engram::posegraph {

/// Closures that say the same, and what the vote between groups left.
struct ClosureGroups {
  std::vector<std::vector<std::size_t>> groups;  ///< positions, along the drive; unusable ones are in none
  std::vector<ClosureDecision> decisions;        ///< kOutvoted, kUnusable or kUnsupported; `support` is set
  std::vector<std::uint32_t>
      late;  ///< of each closure, the later end: position along odometry; 0 for unusable ones
  std::vector<std::uint32_t> trustedLate;  ///< the same of each trusted constraint
};

/// Groups closures whose ends are near each other along odometry at both sides and whose cycle agrees, then
/// keeps the heaviest set of groups without a cycle that disagrees.
ClosureGroups groupClosures(const Graph& trusted, std::span<const Constraint> closures,
                            const GateParams& params, bool planar);

}  // namespace engram::posegraph

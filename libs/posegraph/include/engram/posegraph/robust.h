// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/gating.h"
#include "engram/posegraph/relaxer.h"

#include <span>

namespace engram::posegraph {

/// A relaxation and what became of every closure.
struct RobustRelaxation {
  Relaxation relaxation;                   ///< over the trusted and the accepted constraints
  std::vector<ClosureDecision> decisions;  ///< in the order of the closures
};

/// Decides which closures to believe, and relaxes. `trusted`: places with the current estimate, and
/// constraints that are certainly true (odometry). Closures are grouped where they say the same; groups that
/// contradict each other are voted on with odometry alone; the rest enters from the most certain test to the
/// least, each tested against the estimate that those before it gave. After every relaxation what is in is
/// examined again and what is out may come back. Call it with all closures ever proposed: those once refused
/// return when later ones agree with them. `previous`: the decisions of the last call, on the first of the
/// closures; what they accepted is in from the start unless it is outvoted now, so that one more closure
/// costs little. Without them the poses are drawn from the trusted constraints anew.
RobustRelaxation relaxRobustly(const RelaxerParams& params, const Graph& trusted,
                               std::span<const Constraint> closures,
                               std::span<const ClosureDecision> previous = {});

/// Examines closures against poses that were relaxed with the accepted ones: those that the graph denies
/// leave (a group as one when most of it does), those outside that agree come back. Changes nothing itself;
/// chi-squares are in the decisions. One pass: relax and call again until nothing changes.
std::vector<ClosureDecision> reviewClosures(const Graph& trusted, std::span<const Constraint> closures,
                                            const std::vector<ClosureDecision>& decisions,
                                            const GateParams& params, bool planar = true);

}  // namespace engram::posegraph

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/posegraph/graph.h"

#include <functional>
#include <span>

namespace engram::posegraph {

/// Part of section [posegraph].
struct GateParams {
  double gate_probability = 0.999;
  double gate_inflation = 1.5;      ///< factor on the standard deviations of odometry
  double gate_lone_sigma = 1.0;     ///< [m]
  double gate_support_sigma = 2.0;  ///< [m]
  int gate_support = 2;
  double review_inflation = 2.0;
  void describe(base::Params& p);
};

/// Why a closure is in the graph or not.
enum class ClosureReason {
  kAgrees,           ///< accepted: with the estimate, or with others where the estimate is vague
  kAgainstEstimate,  ///< chi-square against the current estimate too large
  kOutvoted,         ///< other closures, of more weight, contradict it
  kUnsupported,      ///< the estimate is too vague to test it and too few others say the same
  kContradicted,     ///< was accepted; the relaxed graph denies it
  kUnusable,         ///< brokenRule() says why, or an end is unknown, or it has no scale
};
const char* toString(ClosureReason reason);

/// What was decided about one closure, and on which figures.
struct ClosureDecision {
  bool accepted = false;
  ClosureReason reason = ClosureReason::kUnsupported;
  double chi2 = 0;   ///< of the last test
  double sigma = 0;  ///< how well that test knew the position: root of the larger eigenvalue [m]
  int support = 0;   ///< other closures of its group
};

/// Chi-square of a proposed closure against the current estimate. The uncertainty of the estimate is that
/// along the most certain chain between both ends, inflated: more than the true one, so a true closure
/// passes. Accepted if it agrees and the chain is more certain than gate_lone_sigma; kUnsupported if it
/// agrees but the chain is not, or there is none.
ClosureDecision gateClosure(const Graph& graph, const Constraint& proposed, const GateParams& params,
                            bool planar = true);

/// Whether two closures can both be true: chi-square of the cycle through both and the chains of trusted
/// constraints between their ends (pairwise consistency: Mangelson et al. 2018). False as well when the
/// chains do not exist; `sigma` as in ClosureDecision.
ClosureDecision pairConsistency(const Graph& trusted, const Constraint& first, const Constraint& second,
                                const GateParams& params, bool planar = true);

/// The heaviest set without a conflict. Exact where a connected part of the conflicts has up to 24 members,
/// greedy beyond: the one whose conflicts outweigh it most goes first (Mangelson et al. 2018 search
/// the same set as a clique). Ties: the earlier one stays.
std::vector<char> heaviestConsistentSet(std::span<const double> weights,
                                        const std::vector<std::vector<std::size_t>>& conflicts);

/// Largest chi-square of a true measurement, in the share `probability` of cases. dof >= 1.
double chi2Bound(double probability, int dof);

}  // namespace engram::posegraph

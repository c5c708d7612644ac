// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/gating.h"

#include "uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace engram::posegraph {
namespace {

constexpr std::size_t kExactUpTo = 24;
constexpr double kNever = std::numeric_limits<double>::infinity();

bool usable(const Graph& graph, const Constraint& c) {
  return c.T_a_b.hasScale && brokenRule(c).empty() && graph.poses.contains(c.a) && graph.poses.contains(c.b);
}

/// Heaviest set without conflict of a small part, by trying each member in and out.
class ExactSearch {
 public:
  ExactSearch(std::span<const double> weights, const std::vector<std::vector<std::size_t>>& conflicts,
              const std::vector<std::size_t>& members)
      : members_(members), weights_(members.size()), conflicts_(members.size(), 0) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      weights_[i] = weights[members[i]];
      for (const std::size_t other : conflicts[members[i]]) {
        const auto at = std::lower_bound(members.begin(), members.end(), other) - members.begin();
        conflicts_[i] |= 1u << at;
      }
    }
    double rest = 0;
    rest_.assign(members.size() + 1, 0);
    for (std::size_t i = members.size(); i-- > 0;) rest_[i] = rest += weights_[i];
    search(0, 0, 0);
  }

  void mark(std::vector<char>& kept) const {
    for (std::size_t i = 0; i < members_.size(); ++i) kept[members_[i]] = (best_ >> i) & 1u;
  }

 private:
  void search(std::size_t i, std::uint32_t chosen, double weight) {
    if (weight > bestWeight_) {
      bestWeight_ = weight;
      best_ = chosen;
    }
    if (i == weights_.size() || weight + rest_[i] <= bestWeight_) return;
    if ((conflicts_[i] & chosen) == 0) search(i + 1, chosen | (1u << i), weight + weights_[i]);
    search(i + 1, chosen, weight);
  }

  const std::vector<std::size_t>& members_;
  std::vector<double> weights_, rest_;
  std::vector<std::uint32_t> conflicts_;
  std::uint32_t best_ = 0;
  double bestWeight_ = -1;
};

void greedySet(std::span<const double> weights, const std::vector<std::vector<std::size_t>>& conflicts,
               const std::vector<std::size_t>& members, std::vector<char>& kept) {
  std::vector<double> against(weights.size(), 0);
  std::set<std::pair<double, std::size_t>> worst;  // burden and index; the largest leaves
  // A difference, not a ratio: else many light ones that agree leave before the heavy one they all deny.
  const auto burden = [&](std::size_t i) { return against[i] > 1e-9 ? against[i] - weights[i] : -kNever; };
  for (const std::size_t i : members) {
    kept[i] = 1;
    for (const std::size_t other : conflicts[i]) against[i] += weights[other];
    worst.emplace(burden(i), i);
  }
  while (!worst.empty() && worst.rbegin()->first > -kNever) {
    const std::size_t out = worst.rbegin()->second;
    worst.erase(std::prev(worst.end()));
    kept[out] = 0;
    for (const std::size_t other : conflicts[out]) {
      if (!kept[other]) continue;
      worst.erase({burden(other), other});
      against[other] = std::max(0.0, against[other] - weights[out]);
      worst.emplace(burden(other), other);
    }
  }
  // Those whose opponents have all left return, the heaviest first.
  std::vector<std::size_t> gone;
  for (const std::size_t i : members)
    if (!kept[i]) gone.push_back(i);
  std::stable_sort(gone.begin(), gone.end(), [&](auto i, auto j) { return weights[i] > weights[j]; });
  for (const std::size_t i : gone)
    kept[i] = std::none_of(conflicts[i].begin(), conflicts[i].end(), [&](auto j) { return kept[j] != 0; });
}

}  // namespace

void GateParams::describe(base::Params& p) {
  p.add("gate_probability", gate_probability,
        "Share of true closures that pass the chi-square tests, were all covariances right",
        {0.5, 0.9999999});
  p.add("gate_inflation", gate_inflation,
        "Factor on the standard deviations of odometry and of the estimate in the tests", {1, 100});
  p.add("gate_lone_sigma", gate_lone_sigma,
        "Standard deviation of the estimate up to which a closure needs no other to agree with it [m]",
        base::atLeast(0));
  p.add("gate_support_sigma", gate_support_sigma,
        "Standard deviation of odometry between two closures up to which they can support each other [m]",
        base::atLeast(0));
  p.add("gate_support", gate_support, "Closures that have to agree where the estimate is vaguer", {1, 1000});
  p.add("review_inflation", review_inflation,
        "Factor on the standard deviations of a closure when the relaxed graph examines it again", {1, 100});
}

const char* toString(ClosureReason reason) {
  switch (reason) {
    case ClosureReason::kAgrees:
      return "agrees";
    case ClosureReason::kAgainstEstimate:
      return "against the estimate";
    case ClosureReason::kOutvoted:
      return "outvoted";
    case ClosureReason::kUnsupported:
      return "unsupported";
    case ClosureReason::kContradicted:
      return "contradicted";
    case ClosureReason::kUnusable:
      return "unusable";
  }
  return "?";
}

double chi2Bound(double probability, int dof) {
  // Share above x: Q_1 = erfc(sqrt(x / 2)), Q_2 = exp(-x / 2), Q_k = Q_(k-2) + (x/2)^(k/2-1) exp(-x/2) /
  // G(k/2).
  const auto above = [dof](double x) {
    const double half = x / 2;
    double q = dof % 2 == 1 ? std::erfc(std::sqrt(half)) : std::exp(-half);
    for (int k = dof % 2 == 1 ? 3 : 4; k <= dof; k += 2)
      q += std::pow(half, k / 2.0 - 1) * std::exp(-half) / std::tgamma(k / 2.0);
    return q;
  };
  double low = 0, high = 1;
  while (above(high) > 1 - probability && high < 1e4) high *= 2;
  for (int i = 0; i < 60; ++i) (above((low + high) / 2) > 1 - probability ? low : high) = (low + high) / 2;
  return high;
}

ClosureDecision gateClosure(const Graph& graph, const Constraint& c, const GateParams& params, bool planar) {
  ClosureDecision d;
  d.reason = ClosureReason::kUnusable;
  if (!usable(graph, c)) return d;
  ChainFinder finder(graph, planar);
  const auto known = finder.covariance(finder.index().index(c.a), finder.index().index(c.b),
                                       std::numeric_limits<double>::infinity());
  d.reason = ClosureReason::kUnsupported;
  d.sigma = std::numeric_limits<double>::infinity();
  if (!known) return d;
  const Test test = testGap(residual(c.T_a_b, graph.poses.at(c.a), graph.poses.at(c.b)),
                            params.gate_inflation * params.gate_inflation * *known, c.T_a_b.cov, planar);
  d.chi2 = test.chi2;
  d.sigma = test.sigma;
  if (d.chi2 > chi2Bound(params.gate_probability, planar ? 3 : 6))
    d.reason = ClosureReason::kAgainstEstimate;
  else if (d.sigma <= params.gate_lone_sigma)
    d.reason = ClosureReason::kAgrees;
  d.accepted = d.reason == ClosureReason::kAgrees;
  return d;
}

ClosureDecision pairConsistency(const Graph& trusted, const Constraint& first, const Constraint& second,
                                const GateParams& params, bool planar) {
  ClosureDecision d;
  d.reason = ClosureReason::kUnusable;
  if (!usable(trusted, first) || !usable(trusted, second)) return d;
  const TrustedTree tree(trusted, planar);
  const auto test = testCycle(tree, first, second, params, planar);
  d.reason = ClosureReason::kUnsupported;
  d.sigma = std::numeric_limits<double>::infinity();
  if (!test) return d;
  d.chi2 = test->chi2;
  d.sigma = test->sigma;
  d.accepted = d.chi2 <= chi2Bound(params.gate_probability, planar ? 3 : 6);
  d.reason = d.accepted ? ClosureReason::kAgrees : ClosureReason::kOutvoted;
  return d;
}

std::vector<char> heaviestConsistentSet(std::span<const double> weights,
                                        const std::vector<std::vector<std::size_t>>& conflicts) {
  std::vector<char> kept(weights.size(), 1), seen(weights.size(), 0);
  for (std::size_t first = 0; first < weights.size(); ++first) {
    if (seen[first] || conflicts[first].empty()) continue;
    std::vector<std::size_t> part{first};
    seen[first] = 1;
    for (std::size_t at = 0; at < part.size(); ++at)
      for (const std::size_t other : conflicts[part[at]])
        if (!seen[other]) {
          seen[other] = 1;
          part.push_back(other);
        }
    std::sort(part.begin(), part.end());
    if (part.size() <= kExactUpTo)
      ExactSearch(weights, conflicts, part).mark(kept);
    else
      greedySet(weights, conflicts, part, kept);
  }
  return kept;
}

}  // namespace engram::posegraph

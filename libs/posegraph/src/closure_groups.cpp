// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "closure_groups.h"

#include "uncertainty.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace engram::posegraph {
namespace {

constexpr std::uint32_t kReach = 20;    // places between closures that may join directly
constexpr std::uint32_t kLongest = 40;  // places of a group
constexpr std::size_t kLookBack = 40;   // closures before one that are tried
constexpr std::size_t kOpponents = 15;  // groups after one, by either end, that it is held against
constexpr double kHeaviest = 10;        // a long run is one witness more than once, but not without end
constexpr double kImpossible = 4;       // times the bound of chi-square: odometry alone denies the group
constexpr double kVagueYaw = 0.3;       // [rad]: beyond, the linear covariance of a chain says nothing

/// A closure as seen from its later end along odometry.
struct Arc {
  Constraint constraint;
  std::uint32_t late, early;
  std::size_t position;
};

struct Group {
  std::vector<std::size_t> arcs;  // along the drive
  std::uint32_t first = 0;        // late end of its first arc
};

class Grouper {
 public:
  Grouper(const Graph& trusted, std::span<const Constraint> closures, const GateParams& params, bool planar)
      : tree_(trusted, planar),
        params_(params),
        planar_(planar),
        bound_(chi2Bound(params.gate_probability, planar ? 3 : 6)) {
    out_.decisions.resize(closures.size());
    out_.late.assign(closures.size(), 0);
    for (const Constraint& c : trusted.constraints)
      out_.trustedLate.push_back(
          std::max(tree_.order(tree_.index().index(c.a)), tree_.order(tree_.index().index(c.b))));
    for (std::size_t i = 0; i < closures.size(); ++i) {
      const Constraint& c = closures[i];
      if (!c.T_a_b.hasScale || !brokenRule(c).empty() || !trusted.poses.contains(c.a) ||
          !trusted.poses.contains(c.b)) {
        out_.decisions[i].reason = ClosureReason::kUnusable;
        continue;
      }
      const std::uint32_t a = tree_.order(tree_.index().index(c.a)),
                          b = tree_.order(tree_.index().index(c.b));
      out_.late[i] = std::max(a, b);
      if (a >= b)
        arcs_.push_back({c, a, b, i});
      else
        arcs_.push_back({{.a = c.b, .b = c.a, .T_a_b = inverse(c.T_a_b), .robust = true}, b, a, i});
    }
    std::sort(arcs_.begin(), arcs_.end(), [](const Arc& x, const Arc& y) {
      return std::tie(x.late, x.early, x.position) < std::tie(y.late, y.early, y.position);
    });
  }

  ClosureGroups run() {
    form();
    vote();
    for (const Group& g : groups_) {
      std::vector<std::size_t>& members = out_.groups.emplace_back();
      for (const std::size_t k : g.arcs) {
        members.push_back(arcs_[k].position);
        out_.decisions[arcs_[k].position].support = static_cast<int>(g.arcs.size()) - 1;
      }
    }
    return std::move(out_);
  }

 private:
  std::optional<Test> cycle(std::size_t k, std::size_t l) const {
    return testCycle(tree_, arcs_[k].constraint, arcs_[l].constraint, params_, planar_);
  }

  static std::uint32_t gap(std::uint32_t x, std::uint32_t y) { return x > y ? x - y : y - x; }

  void form() {
    std::vector<std::size_t> groupOf(arcs_.size());
    for (std::size_t k = 0; k < arcs_.size(); ++k) {
      std::size_t best = groups_.size();
      std::uint32_t nearest = 2 * kReach + 1;
      for (std::size_t l = k; l-- > 0 && k - l <= kLookBack && arcs_[k].late - arcs_[l].late <= kReach;) {
        const std::uint32_t near = arcs_[k].late - arcs_[l].late + gap(arcs_[k].early, arcs_[l].early);
        if (gap(arcs_[k].early, arcs_[l].early) > kReach || near >= nearest) continue;
        if (arcs_[k].late - groups_[groupOf[l]].first > kLongest) continue;
        const auto test = cycle(l, k);
        if (!test || test->chi2 > bound_ || test->sigma > params_.gate_support_sigma) continue;
        best = groupOf[l];
        nearest = near;
      }
      if (best == groups_.size()) groups_.push_back({{}, arcs_[k].late});
      groups_[best].arcs.push_back(k);
      groupOf[k] = best;
    }
  }

  enum class Relation { kUnknown, kAgreement, kConflict };

  /// Of the cycles through the nearest members of two groups at either end: a conflict when both deny, an
  /// agreement when one that odometry knows well does not.
  Relation relation(const Group& g, const Group& h) const {
    const auto nearestPair = [&](auto end) {
      std::pair<std::size_t, std::size_t> best{g.arcs[0], h.arcs[0]};
      for (const std::size_t k : g.arcs)
        for (const std::size_t l : h.arcs)
          if (gap(end(k), end(l)) < gap(end(best.first), end(best.second))) best = {k, l};
      return best;
    };
    bool denied = true, agreed = false;
    for (const auto& [k, l] : {nearestPair([&](std::size_t x) { return arcs_[x].late; }),
                               nearestPair([&](std::size_t x) { return arcs_[x].early; })}) {
      const auto test = cycle(k, l);
      const bool passes = test && test->chi2 <= bound_;
      denied = denied && test && test->sigmaYaw <= kVagueYaw && !passes;
      agreed = agreed || (passes && test->sigma <= 2 * params_.gate_support_sigma);
    }
    return denied ? Relation::kConflict : agreed ? Relation::kAgreement : Relation::kUnknown;
  }

  /// A group that odometry itself denies is no witness against others.
  bool possible(const Group& g) const {
    const auto test = testCycle(tree_, arcs_[g.arcs[g.arcs.size() / 2]].constraint, params_, planar_);
    return !test || test->sigmaYaw > kVagueYaw || test->chi2 <= kImpossible * bound_;
  }

  void compare(std::size_t i, std::size_t j) {
    if (!possible_[i] || !possible_[j] || !tried_.insert(std::minmax(i, j)).second) return;
    const Relation r = relation(groups_[i], groups_[j]);
    if (r == Relation::kConflict) {
      conflicts_[i].push_back(j);
      conflicts_[j].push_back(i);
    } else if (r == Relation::kAgreement) {
      weights_[i] += own(j);
      weights_[j] += own(i);
    }
  }

  double own(std::size_t i) const { return std::min(kHeaviest, static_cast<double>(groups_[i].arcs.size())); }

  void vote() {
    conflicts_.resize(groups_.size());
    for (std::size_t i = 0; i < groups_.size(); ++i) weights_.push_back(own(i));
    for (const Group& g : groups_) possible_.push_back(possible(g));
    const auto compareAlong = [&](auto end) {
      std::vector<std::size_t> order(groups_.size());
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
      std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return end(i) < end(j); });
      for (std::size_t at = 0; at < order.size(); ++at)
        for (std::size_t next = at + 1; next < order.size() && next <= at + kOpponents; ++next)
          compare(order[at], order[next]);
    };
    const auto middle = [&](std::size_t i) -> const Arc& {
      return arcs_[groups_[i].arcs[groups_[i].arcs.size() / 2]];
    };
    compareAlong([&](std::size_t i) { return middle(i).late; });
    compareAlong([&](std::size_t i) { return middle(i).early; });
    const std::vector<char> kept = heaviestConsistentSet(weights_, conflicts_);
    for (std::size_t i = 0; i < groups_.size(); ++i)
      for (const std::size_t k : groups_[i].arcs)
        if (!kept[i]) out_.decisions[arcs_[k].position].reason = ClosureReason::kOutvoted;
  }

  TrustedTree tree_;
  const GateParams& params_;
  bool planar_;
  double bound_;
  std::vector<Arc> arcs_;
  std::vector<Group> groups_;
  std::vector<double> weights_;
  std::vector<char> possible_;
  std::vector<std::vector<std::size_t>> conflicts_;
  std::set<std::pair<std::size_t, std::size_t>> tried_;
  ClosureGroups out_;
};

}  // namespace

ClosureGroups groupClosures(const Graph& trusted, std::span<const Constraint> closures,
                            const GateParams& params, bool planar) {
  return Grouper(trusted, closures, params, planar).run();
}

}  // namespace engram::posegraph

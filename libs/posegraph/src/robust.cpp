// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/robust.h"

#include "closure_groups.h"
#include "uncertainty.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>

namespace engram::posegraph {
namespace {

constexpr double kFirstLevel = 0.25;  // [m]
constexpr double kNextLevel = 1.4;
constexpr std::size_t kShare = 5;  // relaxed again when one in so many is new
constexpr int kMaxReviews = 8;
constexpr int kMaxTrials = 20;
constexpr int kMaxFailures = 4;
constexpr std::uint32_t kBeside = 60;  // [places]

using Decisions = std::vector<ClosureDecision>;

Graph withAccepted(const Graph& trusted, std::span<const Constraint> closures, const Decisions& decisions) {
  Graph graph = trusted;
  for (std::size_t i = 0; i < closures.size(); ++i) {
    if (!decisions[i].accepted) continue;
    graph.constraints.push_back(closures[i]);
    graph.constraints.back().robust = true;
  }
  return graph;
}

void set(ClosureDecision& d, bool accepted, ClosureReason reason) {
  d.accepted = accepted;
  d.reason = reason;
}

/// Tests closures against one estimate.
class Gate {
 public:
  Gate(const Graph& graph, const GateParams& params, bool planar)
      : graph_(graph),
        params_(params),
        planar_(planar),
        bound_(chi2Bound(params.gate_probability, planar ? 3 : 6)),
        finder_(graph, planar) {}

  /// Whether a closure agrees and the estimate is better than `sigma`; fills chi2 and sigma.
  bool agrees(const Constraint& c, double sigma, ClosureDecision& d) {
    d.sigma = std::numeric_limits<double>::infinity();
    const auto gap = residual(c.T_a_b, graph_.poses.at(c.a), graph_.poses.at(c.b));
    // No covariance that narrow forgives so wide a gap: no need to search for it.
    d.chi2 = gap.head<2>().squaredNorm() / (sigma * sigma + c.T_a_b.cov.topLeftCorner<3, 3>().trace());
    return d.chi2 <= bound_ && explain(c, sigma, d) && d.chi2 <= bound_;
  }

  /// Fills chi2 and sigma; whether the estimate is better than `sigma`.
  bool explain(const Constraint& c, double sigma, ClosureDecision& d) {
    const double factor = params_.gate_inflation * params_.gate_inflation;
    const auto known = finder_.covariance(finder_.index().index(c.a), finder_.index().index(c.b),
                                          4 * sigma * sigma / factor);
    if (!known) return false;
    const auto gap = residual(c.T_a_b, graph_.poses.at(c.a), graph_.poses.at(c.b));
    const Test test = testGap(gap, factor * *known, c.T_a_b.cov, planar_);
    d.chi2 = test.chi2;
    d.sigma = test.sigma;
    return d.sigma <= sigma;
  }

 private:
  const Graph& graph_;
  const GateParams& params_;
  bool planar_;
  double bound_;
  ChainFinder finder_;
};

/// One call of relaxRobustly().
class Judge {
 public:
  Judge(const RelaxerParams& params, const Graph& trusted, std::span<const Constraint> closures,
        std::span<const ClosureDecision> previous)
      : params_(params),
        trusted_(trusted),
        closures_(closures),
        groups_(groupClosures(trusted, closures, params.gate, params.planar)) {
    result_.decisions = groups_.decisions;
    RelaxerParams between = params;
    // Between the rounds no kernel that lets go: what has just come in may be far off.
    if (params.kernel != "none") between.kernel = "huber";
    between_ = makeRelaxer(between);
    result_.relaxation.poses = trusted.poses;
    for (std::size_t i = 0; i < std::min(previous.size(), closures.size()); ++i)
      if (previous[i].accepted && mayEnter(i)) set(result_.decisions[i], true, ClosureReason::kAgrees);
  }

  RobustRelaxation run() {
    relax(*between_);
    if (review()) relax(*between_);
    enter();
    for (int i = 0; i < kMaxTrials && failures_ < kMaxFailures && tryWithoutTheWorst(); ++i) {
    }
    relax(*makeRelaxer(params_));
    settle();
    explainRefusals();
    return std::move(result_);
  }

 private:
  /// From the most certain test to the least, until nothing more comes in.
  void enter() {
    const double widest = extent();
    settle();
    std::size_t pending = 0;
    for (double level = kFirstLevel; level < widest || pending > 0; level *= kNextLevel) {
      pending += admit(level);
      if (pending * kShare <= accepted() - pending && (level < widest || pending == 0)) continue;
      relax(*between_);
      if (review()) relax(*between_);
      // What has come in makes the tests of the rest sharper.
      settle();
      pending = 0;
      level = kFirstLevel / kNextLevel;
    }
    for (int i = 0; i < kMaxReviews && review(); ++i) relax(*between_);
  }

  static std::ptrdiff_t countBeside(const std::vector<std::uint32_t>& sorted, std::uint32_t at) {
    return std::upper_bound(sorted.begin(), sorted.end(), at + kBeside) -
           std::lower_bound(sorted.begin(), sorted.end(), at - std::min(at, kBeside));
  }

  /// Where the relaxed graph denies a trusted constraint, by position along the drive.
  std::vector<std::uint32_t> strainedOdometry() const {
    const double bound = chi2Bound(params_.gate.gate_probability, params_.planar ? 3 : 6);
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i < trusted_.constraints.size(); ++i) {
      const Constraint& c = trusted_.constraints[i];
      if (!c.T_a_b.hasScale) continue;
      const auto gap = residual(c.T_a_b, trusted_.poses.at(c.a), trusted_.poses.at(c.b));
      if (testGap(gap, types::Matrix6d::Zero(), c.T_a_b.cov, params_.planar).chi2 > bound)
        out.push_back(groups_.trustedLate[i]);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  /// A run of lies that came in first bends odometry around itself and has the truth beside it refused. The
  /// accepted group with most refused closures beside it, and odometry under strain, leaves for a trial, and
  /// what was denied may enter again; the larger set of the two stays. Returns whether there was a group left
  /// to try.
  bool tryWithoutTheWorst() {
    std::vector<std::uint32_t> refused;  // by position along the drive
    for (std::size_t i = 0; i < closures_.size(); ++i)
      if (!result_.decisions[i].accepted &&
          (mayEnter(i) || result_.decisions[i].reason == ClosureReason::kContradicted))
        refused.push_back(groups_.late[i]);
    std::sort(refused.begin(), refused.end());
    const std::vector<std::uint32_t> strained = strainedOdometry();
    std::size_t worst = groups_.groups.size();
    std::ptrdiff_t most = 0;
    for (std::size_t g = 0; g < groups_.groups.size(); ++g) {
      const auto& members = groups_.groups[g];
      const std::size_t middle = members[members.size() / 2];
      if (tried_.contains(g) || !result_.decisions[middle].accepted) continue;
      const std::uint32_t at = groups_.late[middle];
      if (countBeside(strained, at) == 0) continue;
      const auto beside = countBeside(refused, at);
      if (beside > std::max(most, static_cast<std::ptrdiff_t>(members.size()) / 2)) {
        most = beside;
        worst = g;
      }
    }
    if (worst == groups_.groups.size()) return false;
    tried_.insert(worst);
    const RobustRelaxation before = result_;
    const std::size_t count = accepted();
    for (ClosureDecision& d : result_.decisions)
      if (d.reason == ClosureReason::kContradicted) d.reason = ClosureReason::kUnsupported;
    for (const std::size_t i : groups_.groups[worst])
      set(result_.decisions[i], false, ClosureReason::kContradicted);
    relax(*between_);
    enter();
    if (accepted() > count) {
      failures_ = 0;
      return true;
    }
    ++failures_;
    // Its neighbours would fare the same.
    for (std::size_t g = 0; g < groups_.groups.size(); ++g) {
      const std::uint32_t at = groups_.late[groups_.groups[g].front()],
                          there = groups_.late[groups_.groups[worst].front()];
      if (std::max(at, there) - std::min(at, there) < kBeside / 4) tried_.insert(g);
    }
    result_ = before;
    trusted_.poses = result_.relaxation.poses;
    return true;
  }

  /// The extent of the estimate [m]: no level needs to be wider.
  double extent() const {
    double most = 1;
    for (const auto& [id, T] : trusted_.poses) most = std::max(most, T.translation().norm());
    return most;
  }

  bool mayEnter(std::size_t i) const {
    const ClosureReason reason = result_.decisions[i].reason;
    return reason != ClosureReason::kOutvoted && reason != ClosureReason::kContradicted &&
           reason != ClosureReason::kUnusable;
  }

  std::size_t accepted() const {
    return static_cast<std::size_t>(std::count_if(result_.decisions.begin(), result_.decisions.end(),
                                                  [](const ClosureDecision& d) { return d.accepted; }));
  }

  /// The graph that tests are made against: as it was last relaxed.
  void settle() {
    graph_ = withAccepted(trusted_, closures_, result_.decisions);
    gate_.emplace(graph_, params_.gate, params_.planar);
  }

  /// Lets in what agrees with the estimate where that is better than `level`. Returns how many did.
  std::size_t admit(double level) {
    std::size_t count = 0;
    for (const auto& members : groups_.groups) {
      const bool supported = static_cast<int>(members.size()) >= params_.gate.gate_support;
      if (!supported && level > params_.gate.gate_lone_sigma) continue;
      const std::size_t speaker = members[members.size() / 2];
      ClosureDecision& d = result_.decisions[speaker];
      if (d.accepted || !mayEnter(speaker)) continue;
      if (!gate_->agrees(closures_[speaker], level, d)) continue;
      count += members.size();
      for (const std::size_t i : members) set(result_.decisions[i], true, ClosureReason::kAgrees);
    }
    return count;
  }

  void explainRefusals() {
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      ClosureDecision& d = result_.decisions[i];
      if (!d.accepted && mayEnter(i) && gate_->explain(closures_[i], params_.gate.gate_lone_sigma, d))
        d.reason = ClosureReason::kAgainstEstimate;
    }
  }

  bool review() {
    const Decisions after =
        reviewClosures(trusted_, closures_, result_.decisions, params_.gate, params_.planar);
    bool changed = false;
    for (std::size_t i = 0; i < after.size(); ++i)
      changed |= after[i].accepted != result_.decisions[i].accepted;
    result_.decisions = after;
    return changed;
  }

  void relax(const Relaxer& relaxer) {
    result_.relaxation = relaxer.relax(withAccepted(trusted_, closures_, result_.decisions));
    if (result_.relaxation.ending != Ending::kFailed) trusted_.poses = result_.relaxation.poses;
  }

  const RelaxerParams& params_;
  Graph trusted_;  // poses: the estimate so far
  std::span<const Constraint> closures_;
  ClosureGroups groups_;
  Graph graph_;
  std::set<std::size_t> tried_;  // groups
  int failures_ = 0;
  std::optional<Gate> gate_;
  std::unique_ptr<Relaxer> between_;
  RobustRelaxation result_;
};

}  // namespace

std::vector<ClosureDecision> reviewClosures(const Graph& trusted, std::span<const Constraint> closures,
                                            const Decisions& decisions, const GateParams& params,
                                            bool planar) {
  Decisions out = decisions;
  const double bound = chi2Bound(params.gate_probability, planar ? 3 : 6);
  const Graph graph = withAccepted(trusted, closures, decisions);
  Gate gate(graph, params, planar);
  const types::Matrix6d nothing = types::Matrix6d::Zero();
  for (std::size_t i = 0; i < closures.size(); ++i) {
    const Constraint& c = closures[i];
    if (out[i].reason == ClosureReason::kUnusable) continue;
    if (decisions[i].accepted) {
      const double factor = params.review_inflation * params.review_inflation;
      out[i].chi2 = testGap(residual(c.T_a_b, graph.poses.at(c.a), graph.poses.at(c.b)), nothing,
                            factor * c.T_a_b.cov, planar)
                        .chi2;
      if (out[i].chi2 > bound) set(out[i], false, ClosureReason::kContradicted);
    } else if (gate.agrees(c, params.gate_lone_sigma, out[i])) {
      set(out[i], true, ClosureReason::kAgrees);
    }
  }
  return out;
}

RobustRelaxation relaxRobustly(const RelaxerParams& params, const Graph& trusted,
                               std::span<const Constraint> closures,
                               std::span<const ClosureDecision> previous) {
  requireValid(trusted);
  base::validate(params);
  return Judge(params, trusted, closures, previous).run();
}

}  // namespace engram::posegraph

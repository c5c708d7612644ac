// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/lru.h"

#include "engram/upkeep/clusters.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

namespace engram::upkeep {
namespace {

/// A neighbourhood from which views are deleted one by one.
class Neighbourhood {
 public:
  Neighbourhood(std::span<const LruView> views, const LruView& added, const Eigen::MatrixXd& closeness,
                const LruRule& rule)
      : views_(views.begin(), views.end()), rule_(rule), cluster_(singleLinkage(closeness, rule.tau)) {
    views_.push_back(added);
    if (!rule.probation)
      for (LruView& v : views_)
        if (v.standing == Standing::kProbation) v.standing = Standing::kUnmatched;
    alive_.assign(views_.size(), true);
    for (const std::size_t c : cluster_) ++exemplars_[c];
    matchAdded(closeness);
  }

  LruPlan plan() && {
    if (rule_.probation) endProbations();
    while (counted() > rule_.max_views) remove(oldest());
    for (std::size_t i = 0; i < views_.size(); ++i)
      if (alive_[i]) plan_.kept.push_back(views_[i]);
    return std::move(plan_);
  }

 private:
  /// The new view tells which views are still seen, and these tell whether it is one of a kind.
  void matchAdded(const Eigen::MatrixXd& closeness) {
    LruView& added = views_.back();
    added.standing = Standing::kUnmatched;
    for (std::size_t i = 0; i + 1 < views_.size(); ++i) {
      if (closeness(static_cast<Eigen::Index>(i), closeness.cols() - 1) > rule_.tau) continue;
      LruView& seen = views_[i];
      added.standing = Standing::kConfirmed;
      if (rule_.touch_on_match) seen.stamp = std::max(seen.stamp, added.stamp);
      if (rule_.touch_on_match || rule_.probation) seen.standing = Standing::kConfirmed;
    }
  }

  /// Probations that the new view did not confirm are over; its own begins when there is no room (K-E8).
  void endProbations() {
    for (std::size_t i = 0; i + 1 < views_.size(); ++i)
      if (views_[i].standing == Standing::kProbation) remove(i);
    if (views_.back().standing == Standing::kUnmatched && counted() > rule_.max_views)
      views_.back().standing = Standing::kProbation;
  }

  int counted() const {
    int n = 0;
    for (std::size_t i = 0; i < views_.size(); ++i)
      n += alive_[i] && views_[i].standing != Standing::kProbation ? 1 : 0;
    return n;
  }

  /// Of the clusters with more than one exemplar if there are any, else of all.
  std::size_t oldest() const {
    const auto age = [&](std::size_t i) {
      const LruView& v = views_[i];
      const bool single = exemplars_.at(cluster_[i]) == 1;
      return std::tuple(single, v.standing == Standing::kConfirmed, v.stamp, v.id);
    };
    std::size_t found = views_.size();
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (!alive_[i] || views_[i].standing == Standing::kProbation) continue;
      if (found == views_.size() || age(i) < age(found)) found = i;
    }
    return found;
  }

  void remove(std::size_t i) {
    alive_[i] = false;
    --exemplars_.at(cluster_[i]);
    auto& deletion = plan_.deleted.emplace_back(LruDeletion{views_[i].id});
    for (std::size_t j = 0; j < views_.size(); ++j)
      if (alive_[j] && cluster_[j] == cluster_[i]) deletion.mates.push_back(views_[j].id);
    std::sort(deletion.mates.begin(), deletion.mates.end());
  }

  std::vector<LruView> views_;  // the new one last
  LruRule rule_;
  std::vector<std::size_t> cluster_;  // of each view
  std::vector<bool> alive_;
  std::map<std::size_t, int> exemplars_;  // of each cluster
  LruPlan plan_;
};

}  // namespace

LruPlan planDeletion(std::span<const LruView> views, const LruView& added, const Eigen::MatrixXd& closeness,
                     const LruRule& rule) {
  const auto n = static_cast<Eigen::Index>(views.size()) + 1;
  if (closeness.rows() != n || closeness.cols() != n)
    throw std::invalid_argument("planDeletion: one row and column of closeness for each view are needed");
  if (rule.max_views < 1)
    throw std::invalid_argument("planDeletion: a neighbourhood keeps at least one view");
  return Neighbourhood(views, added, closeness, rule).plan();
}

}  // namespace engram::upkeep

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "indexed_graph.h"
#include "relaxers.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <queue>

namespace engram::posegraph {
namespace {

/// Variance of a place that stays (A-12: "a small value"), and the least of an edge (A-E7).
constexpr double kSmallVariance = 1e-6;

struct Place {
  double x, y, yaw, variance;
};

/// An edge as its first end sees it; the other way round it is the inverse pose (A-E2).
struct Edge {
  double x, y, yaw, variance;
  bool used;
};

Edge asEdge(const Constraint& c) {
  const auto& [T, cov, hasScale] = c.T_a_b;
  // One weight for position and heading (A-24, A-E8): 1 rad counts as 1 m.
  const double variance = (cov(0, 0) + cov(1, 1)) / 2 + cov(5, 5);
  return {T.translation().x(), T.translation().y(), yawOf(T), std::max(kSmallVariance, variance), hasScale};
}

/// Relaxation after Duckett et al. (2000) with headings, eq (1) to (8).
class Sweeper {
 public:
  Sweeper(const Graph& graph, const std::set<PlaceId>& held)
      : index_(graph), fixed_(index_.anchors(held)), graph_(graph) {
    for (const auto& [id, T] : graph.poses)
      places_.push_back({T.translation().x(), T.translation().y(), yawOf(T), -1});
    for (const Constraint& c : graph.constraints) edges_.push_back(asEdge(c));
    spreadVariance();
  }

  /// Every place once, in order, with what its neighbours have become (Gauss-Seidel). Returns the mean change
  /// [m], where 1 rad counts as 1 m.
  double sweep() {
    double change = 0;
    for (std::size_t i = 0; i < places_.size(); ++i)
      if (!fixed_[i]) change += settle(i);
    return change / static_cast<double>(places_.size());
  }

  std::map<PlaceId, Eigen::Isometry3d> poses() const {
    auto out = graph_.poses;
    std::size_t i = 0;
    for (auto& [id, T] : out) {
      if (!fixed_[i]) setPlanar(T, places_[i].x, places_[i].y, places_[i].yaw);
      ++i;
    }
    return out;
  }

  std::map<PlaceId, double> variances() const {
    std::map<PlaceId, double> out;
    for (std::size_t i = 0; i < places_.size(); ++i) out[index_.id(i)] = places_[i].variance;
    return out;
  }

 private:
  /// the variance of the previous place and that of the edge, here along the most certain chain.
  void spreadVariance() {
    using Item = std::pair<double, std::uint32_t>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    for (std::uint32_t i = 0; i < places_.size(); ++i)
      if (fixed_[i]) queue.emplace(kSmallVariance, i);
    while (!queue.empty()) {
      const auto [variance, i] = queue.top();
      queue.pop();
      if (places_[i].variance >= 0) continue;
      places_[i].variance = variance;
      for (const auto& arm : index_.arms(i))
        if (edges_[arm.constraint].used && places_[arm.to].variance < 0)
          queue.emplace(variance + edges_[arm.constraint].variance, arm.to);
    }
    // Joined by directions alone: nothing moves them.
    for (Place& p : places_) p.variance = std::max(p.variance, kSmallVariance);
  }

  double settle(std::size_t i) {
    double w = 0, x = 0, y = 0, sine = 0, cosine = 0;
    int n = 0;
    for (const auto& arm : index_.arms(i)) {
      const Edge& e = edges_[arm.constraint];
      if (!e.used) continue;
      const Place seen = predicted(places_[arm.to], e, index_.b(arm.constraint) == i);
      const double weight = 1 / seen.variance;
      w += weight;
      x += weight * seen.x;
      y += weight * seen.y;
      sine += weight * std::sin(seen.yaw);
      cosine += weight * std::cos(seen.yaw);
      ++n;
    }
    if (n == 0) return 0;
    Place& p = places_[i];
    const Place old = p;
    // Eq (6), (7): the weighted mean, normalised by its own weights (A-E3, A-E4).
    p.x = x / w;
    p.y = y / w;
    // Eq (8) with atan2; opposite headings cancel, and the old one stays (A-E1).
    if (std::hypot(sine, cosine) > 1e-9 * w) p.yaw = std::atan2(sine, cosine);
    p.variance = n / w;  // eq (4): grows from sweep to sweep, a weight and no uncertainty (A-E5)
    return std::hypot(p.x - old.x, p.y - old.y) + std::abs(std::remainder(p.yaw - old.yaw, 2 * M_PI));
  }

  /// Eq (1) to (3): where neighbour j puts place i; `forwards`: the edge leads from j to i.
  static Place predicted(const Place& j, const Edge& e, bool forwards) {
    const double yaw = forwards ? j.yaw : j.yaw - e.yaw;
    const double c = std::cos(yaw), s = std::sin(yaw), sign = forwards ? 1 : -1;
    return {j.x + sign * (c * e.x - s * e.y), j.y + sign * (s * e.x + c * e.y), j.yaw + sign * e.yaw,
            j.variance + e.variance};
  }

  IndexedGraph index_;
  std::vector<char> fixed_;
  const Graph& graph_;
  std::vector<Place> places_;
  std::vector<Edge> edges_;
};

class DuckettRelaxer : public Relaxer {
 public:
  explicit DuckettRelaxer(const RelaxerParams& params) : params_(params) {}

 private:
  Relaxation run(const Graph& graph, const std::set<PlaceId>& held, bool online) const override {
    Relaxation out;
    out.poses = graph.poses;
    if (graph.constraints.empty()) return out;
    const auto start = std::chrono::steady_clock::now();
    Sweeper sweeper(graph, held);
    const int limit = online ? params_.window_iterations : params_.duckett_max_sweeps;
    out.chi2Before = chi2(graph, graph.poses, true);
    out.ending = Ending::kIterationLimit;
    while (out.iterations < limit && out.ending != Ending::kConverged) {
      ++out.iterations;
      if (sweeper.sweep() < params_.duckett_tolerance) out.ending = Ending::kConverged;
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      if (params_.max_seconds > 0 && spent.count() > params_.max_seconds) break;
    }
    out.poses = sweeper.poses();
    out.variances = sweeper.variances();
    out.chi2After = chi2(graph, out.poses, true);
    return out;
  }

  RelaxerParams params_;
};

}  // namespace

std::unique_ptr<Relaxer> makeDuckettRelaxer(const RelaxerParams& params) {
  return std::make_unique<DuckettRelaxer>(params);
}

}  // namespace engram::posegraph

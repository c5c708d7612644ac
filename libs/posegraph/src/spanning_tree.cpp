// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/graph.h"

#include <queue>
#include <set>
#include <tuple>

namespace engram::posegraph {
namespace {

/// Dijkstra's algorithm over variances. Hop counts would run through weak edges and ruin the first guess.
class Tree {
 public:
  Tree(Graph& graph, double metresPerRadian) : graph_(graph) {
    for (std::size_t i = 0; i < graph.constraints.size(); ++i) {
      const Constraint& c = graph.constraints[i];
      const auto& cov = c.T_a_b.cov;
      double variance = cov.topLeftCorner<3, 3>().trace() +
                        metresPerRadian * metresPerRadian * cov.bottomRightCorner<3, 3>().trace();
      // A unit step instead of a length: wrong by about itself.
      if (!c.T_a_b.hasScale) variance += 1.0;
      arms_[c.a].push_back({c.b, i, variance});
      arms_[c.b].push_back({c.a, i, variance});
    }
  }

  void growFrom(const std::set<PlaceId>& roots) {
    using Item =
        std::tuple<double, PlaceId, PlaceId, std::size_t>;  // variance so far, place, its parent, constraint
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    const auto push = [&](double variance, PlaceId from) {
      for (const Arm& arm : arms_[from])
        if (!graph_.poses.contains(arm.to))
          queue.emplace(variance + arm.variance, arm.to, from, arm.constraint);
    };
    for (const PlaceId root : roots) push(0, root);
    while (!queue.empty()) {
      const auto [variance, place, parent, index] = queue.top();
      queue.pop();
      if (graph_.poses.contains(place)) continue;
      const Constraint& c = graph_.constraints[index];
      const Eigen::Isometry3d& T_a_b = c.T_a_b.T_a_b;
      graph_.poses[place] = graph_.poses.at(parent) * (c.a == parent ? T_a_b : T_a_b.inverse());
      push(variance, place);
    }
  }

 private:
  struct Arm {
    PlaceId to;
    std::size_t constraint;
    double variance;
  };
  Graph& graph_;
  std::map<PlaceId, std::vector<Arm>> arms_;
};

}  // namespace

void addMissingPoses(Graph& graph, double metresPerRadian) {
  Tree tree(graph, metresPerRadian);
  std::set<PlaceId> roots;
  for (const auto& [id, T] : graph.poses) roots.insert(id);
  tree.growFrom(roots);
  std::set<PlaceId> missing;
  for (const Constraint& c : graph.constraints)
    for (const PlaceId id : {c.a, c.b})
      if (!graph.poses.contains(id)) missing.insert(id);
  while (!missing.empty()) {
    // A part without any pose: its first place becomes the origin.
    graph.poses[*missing.begin()] = Eigen::Isometry3d::Identity();
    tree.growFrom({*missing.begin()});
    std::erase_if(missing, [&](PlaceId id) { return graph.poses.contains(id); });
  }
}

}  // namespace engram::posegraph

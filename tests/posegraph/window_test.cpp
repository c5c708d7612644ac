// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/window.h"

#include "engram/posegraph/relaxer.h"
#include "graph_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram::posegraph {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

Graph chain(std::uint32_t n) {
  Graph g;
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    g.constraints.push_back(constraint(i, i + 1, planarPose(1, 0, 0), isotropic(0.1, 0.05)));
  addMissingPoses(g);
  return g;
}

std::set<PlaceId> places(const Graph& g) {
  std::set<PlaceId> out;
  for (const auto& [id, T] : g.poses) out.insert(id);
  return out;
}

TEST(Window, HoldsTheHopsAndARim) {
  Graph g = chain(20);
  g.constraints.push_back(constraint(10, 2, planarPose(-8, 0, 0), isotropic(0.1, 0.05)));
  const Adjacency adjacency(g);
  const Window w = windowAround(g, adjacency, p(10), 1, 100);
  EXPECT_THAT(places(w.graph), UnorderedElementsAre(p(1), p(2), p(3), p(8), p(9), p(10), p(11), p(12)));
  EXPECT_THAT(w.held, ElementsAre(p(1), p(3), p(8), p(12)));
  EXPECT_EQ(w.graph.constraints.size(), 7u);  // each once
}

TEST(Window, IsBoundedInPlacesNearestFirst) {
  const Graph g = chain(100);
  const Window w = windowAround(g, Adjacency(g), p(50), 30, 7);
  EXPECT_EQ(w.graph.poses.size() - w.held.size(), 7u);
  EXPECT_THAT(w.held, ElementsAre(p(46), p(54)));
}

TEST(Window, ConstraintsComeOnceForAnyGraph) {
  base::Rng rng(8);
  for (int round = 0; round < 30; ++round) {
    Graph g;
    for (int k = 0; k < 60; ++k) {
      const auto a = rng.below(25), b = rng.below(25);
      if (a != b) g.constraints.push_back(constraint(a, b, planarPose(k, 0, 0), isotropic(0.1, 0.1)));
    }
    addMissingPoses(g);
    const Window w = windowAround(g, Adjacency(g), g.constraints[0].a, 2, 8);
    std::size_t expected = 0;
    const auto inside = [&](PlaceId id) { return w.graph.poses.contains(id) && !w.held.contains(id); };
    for (const Constraint& c : g.constraints) expected += inside(c.a) || inside(c.b);
    EXPECT_EQ(w.graph.constraints.size(), expected);
  }
}

/// A window around the whole graph is the whole graph.
TEST(Window, OverEverythingRelaxesAsTheGraphDoes) {
  Graph g = noisyLoop(4, 20, true, 0.1, 0.05).graph;
  addMissingPoses(g);
  RelaxerParams params;
  params.window_iterations = 200;
  params.max_iterations = 200;
  const auto relaxer = makeRelaxer(params);
  const Window w = windowAround(g, Adjacency(g), p(0), 50, 1000);
  EXPECT_TRUE(w.held.empty());
  const auto all = relaxer->relax(g).poses, window = relaxer->relax(w).poses;
  for (const auto& [id, T] : all) EXPECT_LT(logSe3(T.inverse() * window.at(id)).norm(), 1e-5);
}

TEST(Window, RelaxationLeavesTheRimAndTheRest) {
  for (const char* name : {"ceres", "duckett", "mrpt_levmarq"}) {
    Graph g = noisyLoop(5, 60, true, 0.05, 0.02).graph;
    std::erase_if(g.constraints, [](const Constraint& c) { return c.b.value != (c.a.value + 1) % 60; });
    for (Constraint& c : g.constraints) c.T_a_b.cov = isotropic(0.1, 0.1);
    addMissingPoses(g);
    g.poses[p(30)] = g.poses[p(30)] * planarPose(0.3, 0.2, 0.1);
    const auto before = g.poses;
    RelaxerParams params;
    params.relaxer = name;
    params.window_hops = 4;
    const auto r = relaxAround(*makeRelaxer(params), params, g, Adjacency(g), p(30));
    EXPECT_LT(r.chi2After, r.chi2Before) << name;
    for (const auto& [id, T] : before) {
      const bool inside = id >= p(26) && id <= p(34);
      EXPECT_TRUE(inside || T.matrix() == g.poses.at(id).matrix()) << name << " place " << id.value;
    }
    EXPECT_FALSE(before.at(p(30)).isApprox(g.poses.at(p(30)), 1e-3)) << name;
  }
}

TEST(Window, NamesThePlaceWithoutAPose) {
  Graph g = chain(3);
  g.poses.erase(p(1));
  EXPECT_THROW(windowAround(g, Adjacency(g), p(0), 2, 10), base::Error);
}

}  // namespace
}  // namespace engram::posegraph

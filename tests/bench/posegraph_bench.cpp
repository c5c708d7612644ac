// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "../posegraph/big_graphs.h"
#include "engram/posegraph/relaxer.h"
#include "engram/posegraph/robust.h"

#include <benchmark/benchmark.h>

namespace engram::posegraph {
namespace {

/// Streets with three closures a place, poses from odometry with the closures of the first pass: the graph
/// that a map has when it is relaxed as a whole. Equal weights, for MRPT's sake.
const Graph& streets(std::uint32_t n) {
  static std::map<std::uint32_t, Graph> made;
  const auto known = made.find(n);
  if (known != made.end()) return known->second;
  Drive drive = manhattan(n, 1);
  base::Rng rng(2);
  Graph& g = made[n];
  g = drive.trusted;
  for (Constraint& c : g.constraints) c.robust = false;
  std::map<std::pair<long, long>, std::vector<std::uint32_t>> cells;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Eigen::Vector3d t = drive.truth[i].translation();
    cells[{std::lround(t.x() / 4), std::lround(t.y() / 4)}].push_back(i);
  }
  std::vector<const std::vector<std::uint32_t>*> full;
  for (const auto& [cell, members] : cells)
    if (members.size() > 1) full.push_back(&members);
  while (g.constraints.size() < 4 * static_cast<std::size_t>(n)) {
    const auto& members = *full[rng.below(static_cast<std::uint32_t>(full.size()))];
    const auto size = static_cast<std::uint32_t>(members.size());
    const auto a = members[rng.below(size)], b = members[rng.below(size)];
    if (a + 1 >= b) continue;
    const Eigen::Isometry3d T = drive.truth[a].inverse() * drive.truth[b];
    g.constraints.push_back(
        constraint(a, b, drive_detail::noisy(T, rng, 0.1, 0.1, 0.02), isotropic(0.1, 0.1)));
  }
  for (Constraint& c : g.constraints) c.T_a_b.cov = isotropic(0.1, 0.1);
  // Half a metre and a few degrees off: where maps start from when the last closures were small.
  for (std::uint32_t i = 1; i < n; ++i)
    g.poses[p(i)] = drive_detail::noisy(drive.truth[i], rng, 0.5, 0.5, 0.1);
  return g;
}

void relaxAll(benchmark::State& state, const char* name) {
  const Graph& graph = streets(static_cast<std::uint32_t>(state.range(0)));
  RelaxerParams params;
  params.relaxer = name;
  const auto relaxer = makeRelaxer(params);
  Relaxation r;
  for (auto _ : state) r = relaxer->relax(graph);
  state.counters["chi2Before"] = r.chi2Before;
  state.counters["chi2"] = r.chi2After;
  state.counters["iterations"] = r.iterations;
}
BENCHMARK_CAPTURE(relaxAll, ceres, "ceres")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(50000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(relaxAll, mrpt_levmarq, "mrpt_levmarq")
    ->Arg(1000)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

/// One image: a place and its odometry edge join the map, and the window around it is relaxed. Closures stay
/// in the map, so the window may reach over them.
void relaxOneImage(benchmark::State& state, const char* name) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  Drive drive = manhattan(n, 1);
  Graph graph = drive.trusted;
  graph.constraints.insert(graph.constraints.end(), drive.closures.begin(), drive.closures.end());
  for (std::uint32_t i = 0; i < n; ++i) graph.poses[p(i)] = drive.truth[i];
  Adjacency adjacency(graph);
  RelaxerParams params;
  params.relaxer = name;
  const auto relaxer = makeRelaxer(params);
  base::Rng rng(3);
  double places = 0;
  for (auto _ : state) {
    const std::uint32_t at = 100 + rng.below(n - 100);
    graph.poses[p(at)] = drive_detail::noisy(graph.poses[p(at)], rng, 0.05, 0.05, 0.02);
    const Relaxation r = relaxAround(*relaxer, params, graph, adjacency, p(at));
    places += static_cast<double>(r.poses.size());
  }
  state.counters["places"] = places / static_cast<double>(state.iterations());
}
BENCHMARK_CAPTURE(relaxOneImage, ceres, "ceres")
    ->Arg(1000)
    ->Arg(5000)
    ->Arg(20000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(relaxOneImage, duckett, "duckett")
    ->Arg(1000)
    ->Arg(5000)
    ->Arg(20000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::posegraph

BENCHMARK_MAIN();

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/rng.h"
#include "engram/upkeep/upkeep.h"

#include <benchmark/benchmark.h>

#include <cmath>

namespace engram::upkeep {
namespace {

constexpr double kLane = 0.24;  // [m] between views along a corridor
constexpr int kPasses = 5;      // views at each spot
constexpr int kFeatures = 300;

/// A building of corridors, kPasses views every kLane, each linked to those within 0.5 m: 24 edges a view.
class Building {
 public:
  explicit Building(int views) : spots_(views / kPasses) {
    for (int spot = 0; spot < spots_; ++spot)
      for (int pass = 0; pass < kPasses; ++pass) add(spot);
  }

  base::PlaceId add(int spot) {
    map::Place place;
    place.T_map_place.translation() << kLane * spot, rng_.uniform(-0.05, 0.05), 0;
    place.createdStamp = stamp_++;
    place.memory.edit().features.keypoints.resize(kFeatures);
    place.memory.edit().features.descriptors = types::Descriptors(types::DescriptorKind::kInt8, 4);
    place.memory.edit().features.descriptors.resize(kFeatures);
    place.memory.edit().states.resize(kFeatures);
    for (auto& state : place.memory.edit().states) state.id = place.memory.edit().nextFeatureId++;
    const auto id = map_.addPlace(std::move(place));
    map_.addPathPoint({.anchor = id});
    at_.resize(std::max(at_.size(), static_cast<std::size_t>(spot) + 3));
    for (int near = std::max(0, spot - 2); near <= spot + 2; ++near)
      for (const auto other : at_[static_cast<std::size_t>(near)])
        if (map_.places().contains(other)) link(other, id);
    at_[static_cast<std::size_t>(spot)].push_back(id);
    return id;
  }

  map::TopologicalMap& map() { return map_; }
  int spots() const { return spots_; }

 private:
  void link(base::PlaceId a, base::PlaceId b) {
    map::Edge edge{.type = map::EdgeType::kRecognition, .a = a, .b = b};
    edge.T_a_b.T_a_b = map_.place(a).T_map_place.inverse() * map_.place(b).T_map_place;
    edge.T_a_b.cov = types::Matrix6d::Identity() * 1e-4;
    for (std::uint32_t i = 0; i < 60; ++i) edge.correspondences.emplace_back(i, i);
    map_.addEdge(std::move(edge));
  }

  int spots_;
  base::Rng rng_{1};
  double stamp_ = 0;
  map::TopologicalMap map_;
  std::vector<std::vector<base::PlaceId>> at_;
};

Budget budget() {
  UpkeepParams params;
  params.max_views = 5 * kPasses;  // five spots are within 0.5 m: the next view is one too many
  return params.budget(30);
}

/// What is to be done after one more view, in maps of so many. Argument: views.
void planOne(benchmark::State& state) {
  Building building(static_cast<int>(state.range(0)));
  const auto id = building.add(building.spots() / 2);
  const auto inliers = edgeInliers(building.map());
  std::size_t edits = 0;
  for (auto _ : state) edits = plan(building.map(), id, budget(), inliers).size();
  state.counters["edits"] = static_cast<double>(edits);
  state.counters["near"] = static_cast<double>(neighbourhood(building.map(), id, budget().near).size());
}
BENCHMARK(planOne)->ArgNames({"views"})->Arg(1000)->Arg(5000)->Arg(20000)->Unit(benchmark::kMicrosecond);

/// One view more, planned and done: the map keeps its size. Argument: views.
void addAndForget(benchmark::State& state) {
  Building building(static_cast<int>(state.range(0)));
  const auto inliers = edgeInliers(building.map());
  base::Rng rng(2);
  std::size_t removed = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const auto id = building.add(static_cast<int>(rng.below(static_cast<std::uint32_t>(building.spots()))));
    state.ResumeTiming();
    removed += upkeep::apply(building.map(), plan(building.map(), id, budget(), inliers)).removed.size();
  }
  state.counters["removed"] = static_cast<double>(removed) / static_cast<double>(state.iterations());
}
BENCHMARK(addAndForget)
    ->ArgNames({"views"})
    ->Arg(1000)
    ->Arg(5000)
    ->Arg(20000)
    ->Iterations(500)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace engram::upkeep

BENCHMARK_MAIN();

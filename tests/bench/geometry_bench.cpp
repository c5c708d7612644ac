// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "../geometry/scene.h"
#include "engram/cameras/lifting_table.h"
#include "engram/geometry/verify.h"

#include <benchmark/benchmark.h>

namespace engram::geometry {
namespace {

using namespace testing_scene;

/// verify() on 200 matches; arguments: inliers in percent, 1 for planar and 0 for free motion.
void verifyMatches(benchmark::State& state) {
  const bool planar = state.range(1) == 1;
  base::Rng rng(1);
  std::vector<Views> views;
  for (int i = 0; i < 50; ++i) {
    const double share = static_cast<double>(state.range(0)) / 100;
    views.push_back(toViews(makeScene({.inlierShare = share, .sigma = deg(0.25), .planar = planar}, rng)));
  }
  VerifyParams params;
  params.model = planar ? "planar" : "essential";
  params.max_iterations = planar ? 2000 : 20000;
  std::size_t next = 0;
  double accepted = 0, iterations = 0;
  for (auto _ : state) {
    const Views& v = views[next++ % views.size()];
    const Verification result = verify(v.a, v.b, v.matches, kUp, params);
    accepted += result.ok();
    iterations += result.iterations;
  }
  state.counters["accepted"] = accepted / static_cast<double>(state.iterations());
  state.counters["iterations"] = iterations / static_cast<double>(state.iterations());
}
BENCHMARK(verifyMatches)
    ->ArgNames({"inliers", "planar"})
    ->Args({50, 1})
    ->Args({30, 1})
    ->Args({0, 1})
    ->Args({50, 0})
    ->Args({30, 0})
    ->Unit(benchmark::kMicrosecond);

/// 550 keypoints to rays through the table.
void liftKeypoints(benchmark::State& state) {
  const auto rig = cameras::loadCamera(ENGRAM_SOURCE_DIR "/share/cameras/omni_world.ini");
  const cameras::LiftingTable table(rig);
  base::Rng rng(2);
  std::vector<types::Keypoint> keypoints(550);
  for (auto& k : keypoints) {
    k.x = static_cast<float>(rng.uniform(0, 639));
    k.y = static_cast<float>(rng.uniform(0, 479));
  }
  for (auto _ : state) benchmark::DoNotOptimize(table.bearings(keypoints));
}
BENCHMARK(liftKeypoints)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace engram::geometry

BENCHMARK_MAIN();

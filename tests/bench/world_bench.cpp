// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/world.h"

#include <benchmark/benchmark.h>

namespace {

using namespace engram::world;

const World& office() {
  static const World world = World::preset("office", {});
  return world;
}

// One picture of the office on one core, people and noise included.
void frame(benchmark::State& state, const char* camera) {
  const Session session(office(), 1, presetEyes(camera));
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(session.frame(i++ * 7 % session.size()).image.data);
}
BENCHMARK_CAPTURE(frame, omni_640x480, "omni")->Unit(benchmark::kMillisecond)->MinTime(2);
BENCHMARK_CAPTURE(frame, pinhole_640x480, "pinhole")->Unit(benchmark::kMillisecond)->MinTime(2);
BENCHMARK_CAPTURE(frame, stereo_2x640x480, "stereo")->Unit(benchmark::kMillisecond)->MinTime(2);

void paintBuilding(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(World::preset("office", {}).route().length());
}
BENCHMARK(paintBuilding)->Unit(benchmark::kMillisecond);

void bakeLight(benchmark::State& state) {
  const Appearance appearance = office().appearance(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(Scene(office().building(), appearance, office().library()).boxes().size());
}
BENCHMARK(bakeLight)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();

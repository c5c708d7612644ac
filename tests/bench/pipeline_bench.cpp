// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/pipeline.h"
#include "engram/world/world.h"

#include <benchmark/benchmark.h>

namespace {

using namespace engram;

pipeline::PipelineParams params() {
  pipeline::PipelineParams p;
  p.camera.file = ENGRAM_SOURCE_DIR "/share/cameras/omni_world.ini";
  return p;
}

struct Office {
  world::World world = world::World::preset("office", {});
  map::TopologicalMap map;               // of the first tour, about 80 places
  std::vector<types::Frame> testFrames;  // of another day, at other positions and headings
};

const Office& office() {
  static const Office office = [] {
    Office o;
    const world::Session tour(o.world, 1, world::presetEyes("omni"));
    pipeline::Pipeline mapper(params());
    for (std::size_t i = 0; i < tour.size(); ++i) mapper.process(tour.frame(i));
    o.map = mapper.map();
    const world::Session test(o.world, 2, world::presetEyes("omni"), world::DriveKind::kTest);
    for (std::size_t i = 0; i < test.size(); i += 4) o.testFrames.push_back(test.frame(i));
    return o;
  }();
  return office;
}

// One image from pixels to an answer: SURF, search in all places, filter, verification, and learning when it
// adapts.
void localise(benchmark::State& state, bool adapt) {
  pipeline::Pipeline localizer(params(), office().map,
                               adapt ? pipeline::Use::kAdapting : pipeline::Use::kFrozen);
  std::size_t i = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(localizer.process(office().testFrames[i++ % office().testFrames.size()]).place);
  state.counters["places"] = static_cast<double>(office().map.places().size());
}
BENCHMARK_CAPTURE(localise, frozen, false)->Unit(benchmark::kMillisecond)->MinTime(2);
BENCHMARK_CAPTURE(localise, adapting, true)->Unit(benchmark::kMillisecond)->MinTime(2);

}  // namespace

BENCHMARK_MAIN();

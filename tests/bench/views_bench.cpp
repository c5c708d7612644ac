// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Maps of stereo views, 640 x 480: what an image costs, and the geometry of 15 candidates.
#include "engram/cameras/stereo_rig.h"
#include "engram/memory/static_view.h"
#include "engram/pipeline/pipeline.h"
#include "engram/pipeline/place_match.h"
#include "engram/world/world.h"

#include <benchmark/benchmark.h>

namespace {

using namespace engram;

pipeline::PipelineParams params() {
  pipeline::PipelineParams p;
  p.mapping.nodes = "views";
  p.camera.file = ENGRAM_SOURCE_DIR "/share/cameras/stereo_world.ini";
  p.camera.stereo = true;
  p.extractor.upright = true;
  p.memory.memory = "static";
  p.posegraph.planar = false;
  return p;
}

const std::vector<types::Frame>& frames() {
  static const std::vector<types::Frame> frames = [] {
    world::WorldParams params;
    params.change.people = 0;
    params.drive.spacing = 0.05;
    params.sensor.samples = 1;
    const world::World office = world::World::preset("office", params);
    const world::Session drive(office, 1, world::presetEyes("stereo"));
    std::vector<types::Frame> out;
    for (std::size_t i = 0; i < 60; ++i) out.push_back(drive.frame(i));
    return out;
  }();
  return frames;
}

/// A stretch of a drive, over and over: each round is a drive that wakes up in the map of those before.
void mapping(benchmark::State& state) {
  map::TopologicalMap map;
  std::size_t images = 0;
  for (auto _ : state) {
    pipeline::Pipeline mapper(params(), std::move(map));
    for (const auto& frame : frames()) mapper.process(frame);
    mapper.finish();
    map = mapper.map();
    images += frames().size();
  }
  state.counters["views"] = static_cast<double>(map.places().size());
  state.counters["images/s"] = benchmark::Counter(static_cast<double>(images), benchmark::Counter::kIsRate);
}
BENCHMARK(mapping)->Unit(benchmark::kMillisecond)->Iterations(10);

void geometryOf15(benchmark::State& state) {
  const pipeline::PipelineParams p = params();
  pipeline::Perception perception(p.camera, p.extractor);
  std::vector<types::Features> views;
  for (std::size_t i = 0; i < 16; ++i)
    views.push_back(pipeline::viewFeatures(perception, perception.rectified(frames()[i * 3]), 300));
  std::vector<memory::PlaceMemory> memories;
  for (const auto& view : views) memories.push_back(memory::Static().start(view));
  int verified = 0;
  for (auto _ : state)
    for (std::size_t i = 0; i < 15; ++i)
      verified +=
          pipeline::matchToPlace(views[15], memories[i], p.match, p.stereo, *perception.stereo()).verified();
  benchmark::DoNotOptimize(verified);
  state.counters["features"] = static_cast<double>(views[15].size());
  state.counters["verified"] = static_cast<double>(verified) / static_cast<double>(state.iterations());
}
BENCHMARK(geometryOf15)->Unit(benchmark::kMillisecond);

void describing(benchmark::State& state) {
  const pipeline::PipelineParams p = params();
  pipeline::Perception perception(p.camera, p.extractor);
  const types::StereoPair pair = perception.rectified(frames()[0]);
  for (auto _ : state) benchmark::DoNotOptimize(pipeline::viewFeatures(perception, pair, 300));
}
BENCHMARK(describing)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();

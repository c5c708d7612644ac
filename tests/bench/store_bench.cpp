// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What an image costs to keep: one transaction in a file on the disk, or on a server that ENGRAM_BENCH_SERVER
// names up to its map ("postgresql:///fleet?host=/tmp/pg&map="): there each thread is a robot with a map of
// its own.
#include "../map/sample_map.h"
#include "../store/store_fixture.h"
#include "engram/store/map_file.h"

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>

namespace engram::store {
namespace {

constexpr int kPlaces = 80, kFeatures = 600, kDrives = 8;

/// What of the map an image changes: nothing but the record of the image; a position; the memory of a place
/// too.
enum class Change { kNothing, kPose, kMemory };

map::TopologicalMap fullMap() {
  base::Rng rng(1);
  map::TopologicalMap map;
  for (int i = 0; i < kPlaces; ++i) {
    map::Place place;
    place.memory = testing::randomMemory(rng, kFeatures, kDrives);
    map.addPlace(std::move(place));
  }
  return map;
}

/// Images that change one place after the other.
void commitImages(benchmark::State& state, MapFile& file, Change change) {
  map::TopologicalMap map = fullMap();
  auto report = sampleReport();
  file.commit(map, map.takeChanges(), &report);
  for (auto _ : state) {
    const base::PlaceId place(static_cast<std::uint32_t>(++report.index % kPlaces));
    if (change != Change::kNothing)
      map.setPose(place, testing::planarPose(static_cast<double>(report.index), 0, 0));
    const std::pair range{static_cast<int>(report.index / kPlaces % kFeatures), 2.0f};
    if (change == Change::kMemory) map.measure(place, {&range, 1});
    file.commit(map, map.takeChanges(), &report);
  }
}

void commitAnImage(benchmark::State& state, Change change) {
  const std::string path = std::filesystem::temp_directory_path() / "engram_store_bench.engram";
  for (const char* suffix : {"", "-wal", "-shm", "-lock"}) std::filesystem::remove(path + suffix);
  MapFile file = MapFile::create(path, sampleHeader());
  commitImages(state, file, change);
  file.close();
  for (const char* suffix : {"", "-wal", "-shm", "-lock"}) std::filesystem::remove(path + suffix);
}

BENCHMARK_CAPTURE(commitAnImage, record, Change::kNothing)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(commitAnImage, pose, Change::kPose)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(commitAnImage, memory, Change::kMemory)->Unit(benchmark::kMillisecond);

void commitOnServer(benchmark::State& state) {
  const char* server = std::getenv("ENGRAM_BENCH_SERVER");
  if (server == nullptr) {
    state.SkipWithError("ENGRAM_BENCH_SERVER names no server");
    return;
  }
  const std::string map = server + std::string("bench_") + std::to_string(state.thread_index());
  MapFile file = MapFile::create(map, sampleHeader(), true);
  commitImages(state, file, Change::kMemory);
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(commitOnServer)->ThreadRange(1, 16)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::store

BENCHMARK_MAIN();

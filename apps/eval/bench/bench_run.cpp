// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_run.h"

#include "bench/bench_map.h"
#include "engram/base/interrupt.h"
#include "engram/pipeline/pipeline.h"
#include "engram/pipeline/recogniser.h"
#include "engram/store/map_file.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <unistd.h>

namespace engram::apps {
namespace {

using pipeline::Pipeline;
using pipeline::Recogniser;

double processMs() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// Some arithmetic, and reading all over 1 MB.
double referenceMs() {
  static const std::vector<std::uint32_t> table(1 << 18, 1);
  const double start = processMs();
  std::uint32_t at = 1;
  volatile std::uint32_t sum = 0;
  for (int k = 0; k < 300000; ++k) {
    at = at * 1664525 + 1013904223;
    sum = sum + table[at >> 14];
  }
  return processMs() - start;
}

/// Memory in use, without what was freed and not given back.
std::uint64_t residentBytes() {
  malloc_trim(0);
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

map::TopologicalMap load(const std::string& file) {
  return store::MapFile::open(file, store::Access::kReadOnly).loadOnDemand();
}

class MapBench {
 public:
  MapBench(const BenchImages& images, const pipeline::PipelineParams& params, const BenchAsk& ask,
           std::size_t places, const std::string& file)
      : images_(images), params_(params), ask_(ask), file_(file) {
    figures_.places = places;
    figures_.scorer = params.recognise.scorer;
  }

  BenchFigures measure() {
    figures_.bytes = store::MapFile::open(file_, store::Access::kReadOnly).bytes();
    localise();
    extend();
    compareWithExact();
    return figures_;
  }

 private:
  types::Frame frame(std::size_t i, bool again) const {
    if (base::interrupted()) throw base::Interrupted("measuring");
    return benchFrame(images_, params_, i, again, ask_.wheels);
  }

  bool isNear(base::PlaceId place, std::size_t i) const {
    return place.valid() && std::abs(static_cast<long>(place.value) - static_cast<long>(i)) <= 1;
  }

  /// A drive through the middle of the map. The first answer is part of the opening alone.
  void localise() {
    std::size_t i = figures_.places / 2;
    const types::Frame first = frame(i, true);
    const std::uint64_t before = residentBytes();
    double start = processMs();
    Pipeline localizer(params_, load(file_), pipeline::Use::kFrozen);
    localizer.process(first);
    figures_.open = processMs() - start;
    figures_.rss = residentBytes() - std::min(before, residentBytes());
    for (int k = 0; k < ask_.drive; ++k) {
      i = (i + 1) % figures_.places;
      const types::Frame shown = frame(i, true);
      start = processMs();
      const types::FrameReport report = localizer.process(shown);
      figures_.localise.push_back(processMs() - start);
      figures_.right += isNear(report.bestGuess, i);
      for (const auto& [step, ms] : report.times) figures_.steps[step].push_back(ms);
      figures_.reference.push_back(referenceMs());
    }
  }

  /// The drive that made the map goes on. Its first image begins a session and is not counted.
  void extend() {
    Pipeline mapper(params_, load(file_), pipeline::Use::kBuild);
    mapper.process(frame(figures_.places - 1, true));
    for (int k = 0; k < ask_.drive; ++k) {
      const types::Frame shown = frame(figures_.places + static_cast<std::size_t>(k), false);
      const double start = processMs();
      mapper.process(shown);
      figures_.map.push_back(processMs() - start);
    }
  }

  void compareWithExact() {
    const map::TopologicalMap map = load(file_);
    pipeline::PipelineParams exact = params_;
    exact.recognise.scorer = "ltm_match";
    exact.recognise.exhaustive_places = std::numeric_limits<int>::max();
    const auto in = Recogniser::Mode::kLocalisation;
    Recogniser fast(params_, in), slow(exact, in);
    fast.load(map);
    slow.load(map);
    pipeline::Perception perception(params_.camera, params_.extractor);
    int same = 0;
    for (int k = 0; k < ask_.singles; ++k) {
      const std::size_t i =
          figures_.places * static_cast<std::size_t>(k) / static_cast<std::size_t>(ask_.singles);
      const cv::Mat image = frame(i, true).image;
      if (!perception.refusal(image).empty()) continue;
      const types::Features view = perception(image);
      const base::PlaceId found = mostSimilar(fast, view), wanted = mostSimilar(slow, view);
      same += found == wanted;
      figures_.firstRight += isNear(found, i);
      figures_.exactRight += isNear(wanted, i);
    }
    figures_.recall = ask_.singles > 0 ? static_cast<double>(same) / ask_.singles : 1.0;
  }

  /// The maps of the bench have places 0, 1, 2, …
  static base::PlaceId mostSimilar(const Recogniser& recogniser, const types::Features& view) {
    const std::vector<double> scores = recogniser.similarities(view);
    return base::PlaceId(
        static_cast<std::uint32_t>(std::max_element(scores.begin(), scores.end()) - scores.begin()));
  }

  const BenchImages& images_;
  pipeline::PipelineParams params_;
  BenchAsk ask_;
  std::string file_;
  BenchFigures figures_;
};

}  // namespace

BenchFigures measureMap(const BenchImages& images, const pipeline::PipelineParams& params,
                        const BenchAsk& ask, std::size_t places, const std::string& file) {
  return MapBench(images, params, ask, places, file).measure();
}

}  // namespace engram::apps

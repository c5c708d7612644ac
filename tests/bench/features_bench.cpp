// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One core, 640×480, 550 features: bench_features
#include "dlib_surf.h"
#include "engram/base/rng.h"
#include "engram/features/extractor.h"
#include "engram/features/place_matcher.h"
#include "matching_detail.h"
#include "scene.h"
#include "surf_extractor.h"

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

#include <cstring>

namespace engram::features {
namespace {

using types::DescriptorKind;

const cv::Mat& scene() {
  static const cv::Mat image = test::texturedScene(640, 480, 1);
  return image;
}

ExtractorParams params(const char* name, bool upright = false) {
  ExtractorParams p;
  p.extractor = name;
  p.max_features = 550;
  p.upright = upright;
  return p;
}

void run(benchmark::State& state, const Extractor& extractor) {
  std::size_t found = 0;
  for (auto _ : state) found = extractor.extract(scene(), {}).size();
  state.counters["features"] = static_cast<double>(found);
}

void surf(benchmark::State& state, SimdLevel level, bool upright) {
  if (level > supportedSimd()) return state.SkipWithError("not on this processor");
  run(state, *makeSurfExtractor(params("surf", upright), level));
}
BENCHMARK_CAPTURE(surf, avx2, SimdLevel::kAvx2, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(surf, avx2_upright, SimdLevel::kAvx2, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(surf, portable, SimdLevel::kPortable, false)->Unit(benchmark::kMillisecond);

void opencv(benchmark::State& state, const char* name) { run(state, *makeExtractor(params(name))); }
BENCHMARK_CAPTURE(opencv, sift, "sift")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(opencv, akaze, "akaze")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(opencv, orb, "orb")->Unit(benchmark::kMillisecond);

void dlibSurf(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(test::dlibSurf(scene(), 550));
}
BENCHMARK(dlibSurf)->Unit(benchmark::kMillisecond);

types::Features randomFeatures(base::Rng& rng, DescriptorKind kind, int dim, int count, bool isSigned) {
  types::Features f;
  f.descriptors = types::Descriptors(kind, dim);
  f.keypoints.resize(static_cast<std::size_t>(count));
  f.descriptors.resize(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (isSigned) f.keypoints[i].sign = rng.below(2) ? 1 : -1;
    for (int c = 0; c < dim; ++c) {
      const auto v = static_cast<float>(rng.normal(0, 1 / std::sqrt(dim)));
      std::byte* row = f.descriptors.mutableRow(i);
      if (kind == DescriptorKind::kFloat) std::memcpy(row + 4 * c, &v, 4);
      if (kind == DescriptorKind::kInt8)
        row[c] = static_cast<std::byte>(static_cast<int>(v * types::kInt8Scale));
      if (kind == DescriptorKind::kBinary && v > 0) row[c / 8] |= std::byte(1 << (c % 8));
    }
  }
  return f;
}

/// 600 × 600, preparation included.
void match600(benchmark::State& state, SimdLevel level, DescriptorKind kind, int dim, bool isSigned) {
  if (level > supportedSimd()) return state.SkipWithError("not on this processor");
  base::Rng rng(1);
  const auto a = randomFeatures(rng, kind, dim, 600, isSigned),
             b = randomFeatures(rng, kind, dim, 600, isSigned);
  for (auto _ : state)
    benchmark::DoNotOptimize(detail::matchPrepared(level, PreparedSet(a), PreparedSet(b), {}));
}
#define ENGRAM_MATCH_BENCH(name, level)                                                   \
  BENCHMARK_CAPTURE(match600, surf_float_##name, level, DescriptorKind::kFloat, 64, true) \
      ->Unit(benchmark::kMicrosecond);                                                    \
  BENCHMARK_CAPTURE(match600, surf_int8_##name, level, DescriptorKind::kInt8, 64, true)   \
      ->Unit(benchmark::kMicrosecond);                                                    \
  BENCHMARK_CAPTURE(match600, sift_int8_##name, level, DescriptorKind::kInt8, 128, false) \
      ->Unit(benchmark::kMicrosecond);                                                    \
  BENCHMARK_CAPTURE(match600, akaze_##name, level, DescriptorKind::kBinary, 486, false)   \
      ->Unit(benchmark::kMicrosecond)
ENGRAM_MATCH_BENCH(portable, SimdLevel::kPortable);
ENGRAM_MATCH_BENCH(avx2, SimdLevel::kAvx2);
ENGRAM_MATCH_BENCH(avx512, SimdLevel::kAvx512);

void placeMatcher(benchmark::State& state, DescriptorKind kind, int dim, bool isSigned, int places,
                  int perPlace) {
  base::Rng rng(2);
  PlaceMatcher matcher;
  for (int p = 0; p < places; ++p)
    matcher.set(static_cast<std::size_t>(p), randomFeatures(rng, kind, dim, perPlace, isSigned));
  const auto query = randomFeatures(rng, kind, dim, 600, isSigned);
  for (auto _ : state) benchmark::DoNotOptimize(matcher.ratioMatchCounts(query, {}, 1));
}
BENCHMARK_CAPTURE(placeMatcher, surf_80x284, DescriptorKind::kInt8, 64, true, 80, 284)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(placeMatcher, akaze_80x284, DescriptorKind::kBinary, 486, false, 80, 284)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(placeMatcher, akaze_200x600, DescriptorKind::kBinary, 486, false, 200, 600)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::features

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

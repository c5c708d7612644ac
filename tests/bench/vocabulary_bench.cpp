// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "../vocabulary/make_descriptors.h"
#include "engram/vocabulary/bag_of_words.h"

#include <benchmark/benchmark.h>

namespace engram::vocabulary {
namespace {

/// 600 descriptors of 64 components to the nearest of the words.
void quantise(benchmark::State& state) {
  base::Rng rng(1);
  const auto d = randomFloats(5000, 64, rng);
  const types::Descriptors* images[] = {&d};
  BowParams params;
  params.words = static_cast<int>(state.range(0));
  params.iterations = 2;
  const KMeansDictionary dictionary(images, params);
  const auto queries = types::quantised(randomFloats(600, 64, rng));
  for (auto _ : state) benchmark::DoNotOptimize(dictionary.wordsOf(queries));
}
BENCHMARK(quantise)->ArgNames({"words"})->Arg(80)->Arg(1000)->Unit(benchmark::kMicrosecond);

/// A map of 80 places with the given number of views of 600 descriptors each.
void rebuildBagOfWords(benchmark::State& state) {
  base::Rng rng(2);
  std::vector<types::Descriptors> images;
  std::vector<BagOfWords::View> views;
  for (int v = 0; v < 80 * state.range(0); ++v)
    images.push_back(types::quantised(randomFloats(600, 64, rng)));
  for (const auto& d : images)
    views.push_back({base::PlaceId(static_cast<std::uint32_t>(views.size() % 80)), &d});
  BagOfWords bow({});
  for (auto _ : state) bow.rebuild(views);
}
BENCHMARK(rebuildBagOfWords)
    ->ArgNames({"views"})
    ->Arg(1)
    ->Arg(8)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::vocabulary

BENCHMARK_MAIN();

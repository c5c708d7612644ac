// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "../vocabulary/make_descriptors.h"
#include "engram/vocabulary/bag_of_words.h"
#include "engram/vocabulary/view_index.h"
#include "engram/vocabulary/word_index.h"

#include <benchmark/benchmark.h>

#include <chrono>

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

using types::DescriptorKind;
using types::Descriptors;

/// Descriptors of images come in clusters: rows around 2000 centres.
class Rows {
 public:
  explicit Rows(DescriptorKind kind)
      : binary_(kind == DescriptorKind::kBinary),
        centres_(randomRows(kind, 2000, binary_ ? 256 : 64, rng_)) {}
  Descriptors none() const { return Descriptors(centres_.kind(), centres_.dim()); }
  void appendNew(Descriptors& out) {
    appendSeenAgain(out, centres_, rng_.below(2000), binary_ ? 0.2 : 0.7, rng_);
  }
  void appendAgain(Descriptors& out, const Descriptors& rows, std::size_t i) {
    appendSeenAgain(out, rows, i, binary_ ? 0.07 : 0.22, rng_);
  }
  base::Rng& rng() { return rng_; }

 private:
  base::Rng rng_{3};
  bool binary_;
  Descriptors centres_;
};

/// A map of so many words in places of 600, with one view each.
struct Grown {
  WordIndex words{{}};
  Descriptors rows;

  Grown(Rows& source, std::size_t size) : rows(source.none()) {
    for (std::uint32_t place = 0; rows.size() < size; ++place) {
      Descriptors image = source.none();
      for (int i = 0; i < 600; ++i) source.appendNew(image);
      words.learn(base::PlaceId(place), base::ViewId(place), image, std::vector<WordMatch>(600));
      for (std::size_t i = 0; i < image.size(); ++i) rows.append(image.row(i));
    }
  }
};

/// One image of 600 features, half of them seen before: recognised, then learnt. `recall`: share of those
/// seen before that find their word. Arguments: kind, words in the map.
void recogniseAndLearn(benchmark::State& state) {
  Rows source(static_cast<DescriptorKind>(state.range(0)));
  Grown map(source, static_cast<std::size_t>(state.range(1)));
  const auto view = base::ViewId(static_cast<std::uint32_t>(map.words.index().views().size()));
  double right = 0, lookup = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Descriptors image = source.none();
    std::vector<std::size_t> truth;
    for (int i = 0; i < 300; ++i) {
      truth.push_back(source.rng().below(static_cast<std::uint32_t>(map.rows.size())));
      source.appendAgain(image, map.rows, truth.back());
      source.appendNew(image);
    }
    state.ResumeTiming();
    const auto begin = std::chrono::steady_clock::now();
    const auto seen = map.words.recognise(image);
    lookup += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    map.words.learn(base::PlaceId(view.value), view, image, seen.matches);
    state.PauseTiming();
    map.words.removeView(view);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto& word = seen.matches[2 * i];
      right += word.found() && distanceOf(image, 2 * i, map.rows, truth[i]) >= word.distance - 1e-4f;
    }
    state.ResumeTiming();
  }
  const auto images = static_cast<double>(state.iterations());
  state.counters["recall"] = right / (300 * images);
  state.counters["recognise_ms"] = lookup / images;
  state.counters["words"] = static_cast<double>(map.words.dictionary().size());
}
BENCHMARK(recogniseAndLearn)
    ->ArgNames({"kind", "words"})
    ->ArgsProduct({{static_cast<int>(DescriptorKind::kInt8), static_cast<int>(DescriptorKind::kBinary)},
                   {10000, 100000, 1000000}})
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

/// A vocabulary tree on 200,000 descriptors, and views of 300 features by their words.
struct Trained {
  std::vector<base::WordId> pool;  // words of as many descriptors, as often as they occur
  VocabularyTree tree;

  explicit Trained(Rows& source) : tree(make(source, pool)) {}

  std::vector<base::WordId> view(base::Rng& rng) const {
    std::vector<base::WordId> words(300);
    for (auto& word : words) word = pool[rng.below(static_cast<std::uint32_t>(pool.size()))];
    return words;
  }

 private:
  static VocabularyTree make(Rows& source, std::vector<base::WordId>& pool) {
    Descriptors rows = source.none();
    for (int i = 0; i < 200000; ++i) source.appendNew(rows);
    const Descriptors* images[] = {&rows};
    auto tree = VocabularyTree::train(images, {});
    pool = tree.wordsOf(rows);
    return tree;
  }
};

/// One image of 300 features against so many views: looked up, asked for the best 15, added, and taken out
/// again. Arguments: kind, views.
void recogniseAmongViews(benchmark::State& state) {
  Rows source(static_cast<DescriptorKind>(state.range(0)));
  const Trained trained(source);
  ViewIndex index(trained.tree);
  for (std::uint32_t i = 0; i < state.range(1); ++i) index.add(base::ViewId(i), trained.view(source.rng()));
  const auto id = base::ViewId(static_cast<std::uint32_t>(state.range(1)));
  Descriptors image = source.none();
  for (int i = 0; i < 300; ++i) source.appendNew(image);
  double times[4] = {};
  for (auto _ : state) {
    auto before = std::chrono::steady_clock::now();
    const auto took = [&](double& sum) {
      const auto now = std::chrono::steady_clock::now();
      sum += std::chrono::duration<double, std::milli>(now - before).count();
      before = now;
    };
    const auto words = index.tree().wordsOf(image);
    took(times[0]);
    benchmark::DoNotOptimize(index.query(words));
    took(times[1]);
    index.add(id, words);
    took(times[2]);
    index.remove(id);
    took(times[3]);
  }
  const char* names[] = {"words_ms", "query_ms", "add_ms", "remove_ms"};
  for (int i = 0; i < 4; ++i) state.counters[names[i]] = times[i] / static_cast<double>(state.iterations());
  state.counters["words"] = static_cast<double>(index.tree().words());
  state.counters["index_MB"] = static_cast<double>(index.bytes()) / 1e6;
}
BENCHMARK(recogniseAmongViews)
    ->ArgNames({"kind", "views"})
    ->ArgsProduct({{static_cast<int>(DescriptorKind::kInt8), static_cast<int>(DescriptorKind::kBinary)},
                   {1228, 5000, 20000}})
    ->Unit(benchmark::kMillisecond);

/// Training on so many descriptors. Arguments: kind, descriptors.
void trainTree(benchmark::State& state) {
  Rows source(static_cast<DescriptorKind>(state.range(0)));
  Descriptors rows = source.none();
  for (int i = 0; i < state.range(1); ++i) source.appendNew(rows);
  const Descriptors* images[] = {&rows};
  for (auto _ : state) benchmark::DoNotOptimize(VocabularyTree::train(images, {}));
}
BENCHMARK(trainTree)
    ->ArgNames({"kind", "descriptors"})
    ->ArgsProduct({{static_cast<int>(DescriptorKind::kInt8), static_cast<int>(DescriptorKind::kBinary)},
                   {50000, 200000}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

/// A map of so many words to bytes and back.
void serialise(benchmark::State& state) {
  Rows source(DescriptorKind::kInt8);
  const Grown map(source, static_cast<std::size_t>(state.range(0)));
  std::size_t bytes = 0;
  for (auto _ : state) {
    const auto blob = map.words.serialised();
    bytes = blob.size();
    benchmark::DoNotOptimize(WordIndex::parse(blob));
  }
  state.counters["bytes_per_word"] =
      static_cast<double>(bytes) / static_cast<double>(map.words.dictionary().size());
}
BENCHMARK(serialise)->ArgNames({"words"})->Arg(100000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::vocabulary

BENCHMARK_MAIN();

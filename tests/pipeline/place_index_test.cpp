// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_index.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/memory/static_view.h"
#include "engram/pipeline/scorer.h"
#include "place_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>

namespace engram::pipeline {
namespace {

using types::DescriptorKind;

constexpr int kFeatures = 60;  // of a place

/// Unit vectors around common centres, as the descriptors of buildings are; a view again is the same with
/// noise.
class Views {
 public:
  Views() {
    for (int i = 0; i < 300; ++i) centres_.push_back(random(1.0));
  }

  types::Features make() {
    types::Features view;
    view.descriptors = types::Descriptors(DescriptorKind::kFloat, 64);
    for (int i = 0; i < kFeatures; ++i)
      add(view, centres_[rng_.below(300)] + 0.8f * random(1.0), rng_.below(2) == 0 ? 1 : -1);
    return quantised(view);
  }

  /// The first `kept` features of a view with noise, and others.
  types::Features again(const types::Features& view, int kept) {
    types::Features seen = make();
    types::Features noisy;
    noisy.descriptors = types::Descriptors(DescriptorKind::kFloat, 64);
    for (int i = 0; i < kept; ++i) {
      const auto row = static_cast<std::size_t>(i);
      Vector d =
          Eigen::Map<const Eigen::Matrix<std::int8_t, 64, 1>>(view.descriptors.int8(row)).cast<float>();
      add(noisy, d.normalized() + 0.35f * random(1.0), view.keypoints[row].sign);
    }
    noisy = quantised(noisy);
    for (int i = kept; i < kFeatures; ++i) noisy.append(seen, static_cast<std::size_t>(i));
    return noisy;
  }

  base::Rng& rng() { return rng_; }

 private:
  using Vector = Eigen::Matrix<float, 64, 1>;
  Vector random(double length) {
    Vector v;
    for (int k = 0; k < 64; ++k) v[k] = static_cast<float>(rng_.normal());
    return v.normalized() * static_cast<float>(length);
  }
  static void add(types::Features& view, const Vector& direction, int sign) {
    const Vector d = direction.normalized();
    view.descriptors.append(std::as_bytes(std::span<const float>(d.data(), 64)));
    view.keypoints.push_back({0, 0, 5, 0, 1, static_cast<std::int8_t>(sign)});
  }
  static types::Features quantised(types::Features view) {
    view.descriptors = types::quantised(view.descriptors);
    return view;
  }

  base::Rng rng_{9};
  std::vector<Vector> centres_;
};

types::Descriptors together(const std::vector<types::Features>& views) {
  types::Descriptors all(DescriptorKind::kInt8, 64);
  for (const auto& view : views)
    for (std::size_t i = 0; i < view.size(); ++i) all.append(view.descriptors.row(i));
  return all;
}

std::vector<types::Features> someViews(Views& views, std::size_t n) {
  std::vector<types::Features> list;
  for (std::size_t i = 0; i < n; ++i) list.push_back(views.make());
  return list;
}

// The definition, word by word and pair by pair.
TEST(PlaceFile, VotesAreThoseOfTheDefinition) {
  Views views;
  const auto places = someViews(views, 50);
  const types::Descriptors all = together(places);
  const PlaceWords words = PlaceWords::train(all, 1);
  PlaceFile file(PlaceWords::train(all, 1));
  std::vector<std::vector<PlaceWord>> wordsOf;
  std::vector<int> counts(words.size(), 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    file.set(i, places[i]);
    wordsOf.push_back(words.wordsOf(places[i]));
    for (const PlaceWord& w : wordsOf.back()) ++counts.at(w.word);
  }
  const types::Features view = views.again(places[7], 40);
  std::vector<double> expected(places.size(), 0.0);
  for (const PlaceWord& q : words.wordsOf(view))
    for (std::size_t i = 0; i < places.size(); ++i)
      for (const PlaceWord& w : wordsOf[i]) {
        const int bits = std::popcount(w.signature ^ q.signature);
        const double idf = std::log(50.0 / counts[w.word]);
        if (w.word == q.word && bits <= 22 && idf > 0)
          expected[i] += idf * std::exp(-0.5 * bits * bits / (7.0 * 7.0));
      }
  const std::vector<double> votes = file.votes(view);
  ASSERT_EQ(votes.size(), expected.size());
  for (std::size_t i = 0; i < votes.size(); ++i) EXPECT_NEAR(votes[i] / 4096, expected[i], 0.05) << i;
  EXPECT_EQ(std::max_element(votes.begin(), votes.end()) - votes.begin(), 7);
}

TEST(PlaceFile, EqualContentsGiveEqualVotes) {
  Views views;
  const auto places = someViews(views, 40), others = someViews(views, 40);
  const types::Descriptors all = together(places);
  PlaceFile straight(PlaceWords::train(all, 1)), roundabout(PlaceWords::train(all, 1));
  for (std::size_t i = 0; i < places.size(); ++i) straight.set(i, places[i]);
  for (std::size_t i = places.size(); i-- > 0;) roundabout.set(i, others[i]);
  for (int k = 0; k < 200; ++k) {
    const std::size_t i = views.rng().below(40);
    roundabout.set(i, views.rng().below(2) == 0 ? others[i] : places[i]);
  }
  for (std::size_t i = 0; i < places.size(); ++i) roundabout.set(i, places[i]);
  for (int k = 0; k < 10; ++k) {
    const types::Features view = views.again(places[views.rng().below(40)], 30);
    EXPECT_EQ(straight.votes(view), roundabout.votes(view));
  }
}

TEST(PlaceWords, HoldsForBinaryDescriptorsToo) {
  base::Rng rng(2);
  types::Features view;
  view.descriptors = types::Descriptors(DescriptorKind::kBinary, 256);
  for (int i = 0; i < 900; ++i) {
    std::array<std::uint64_t, 4> row{};
    for (auto& word : row) word = rng.bits();
    view.descriptors.append(std::as_bytes(std::span<const std::uint64_t>(row)));
    view.keypoints.emplace_back();
  }
  const PlaceWords words = PlaceWords::train(view.descriptors, 1);
  std::set<std::uint32_t> used;
  for (const PlaceWord& w : words.wordsOf(view)) {
    EXPECT_LT(w.word, words.size());
    used.insert(w.word);
  }
  EXPECT_GT(used.size(), 90u);
}

/// A map of such views, and its scorers.
struct Large {
  explicit Large(std::size_t n) {
    for (const auto& view : someViews(views, n)) {
      map::Place place;
      place.memory = memory::Static().start(view);
      map.addPlace(std::move(place));
    }
  }
  std::unique_ptr<Scorer> scorer(int exhaustive, int proposals) const {
    PipelineParams params;
    params.recognise.exhaustive_places = exhaustive;
    params.recognise.proposals = proposals;
    auto made = makeScorer(params);
    for (const auto& [id, place] : map.places()) made->placeChanged(id.value, place);
    made->settled(map);
    return made;
  }
  types::Features seenAgain(std::size_t place, int kept) {
    return views.again(map.place(base::PlaceId(static_cast<std::uint32_t>(place))).memory->features, kept);
  }
  Views views;
  map::TopologicalMap map;
};

std::size_t first(const std::vector<double>& scores) {
  return static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
}

double medianOf(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviationOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += (v - meanOf(values)) * (v - meanOf(values));
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Exact search is the oracle: its first place is proposed, places that were looked at have its scores, and
/// the others lie where those of exact search lie.
TEST(LtmMatchScorer, IndexedFindsWhatExactSearchFinds) {
  Large large(600);
  const auto exact = large.scorer(1000, 40), indexed = large.scorer(100, 40);
  int same = 0, equal = 0;
  std::vector<double> medians, means,
      deviations;  // of the indexed scores, less or over those of exact search
  const int asked = 60;
  for (int k = 0; k < asked; ++k) {
    const types::Features view = large.seenAgain(static_cast<std::size_t>(10 * k), 14);
    const auto a = exact->scores(view), b = indexed->scores(view);
    ASSERT_EQ(a.size(), b.size());
    same += first(a) == first(b);
    for (std::size_t i = 0; i < a.size(); ++i) equal += a[i] == b[i];
    medians.push_back(medianOf(b) - medianOf(a));
    means.push_back(meanOf(b) - meanOf(a));
    deviations.push_back(deviationOf(b) / deviationOf(a));
  }
  EXPECT_GE(same, asked * 95 / 100);
  EXPECT_NEAR(meanOf(medians), 0, 0.01);  // of 0.27; one match is 0.03
  EXPECT_NEAR(meanOf(means), 0, 0.01);
  EXPECT_NEAR(meanOf(deviations), 1, 0.1);
  EXPECT_GE(equal, asked * 80);  // 40 proposals, a sample of 48
}

TEST(LtmMatchScorer, LikelyPlacesAreMatchedWhateverTheIndexSays) {
  Large large(300);
  const auto exact = large.scorer(1000, 1), indexed = large.scorer(100, 1);
  const std::vector<std::size_t> likely{3, 50, 51, 299};
  const types::Features view = large.seenAgain(120, 30);
  const auto a = exact->scores(view), b = indexed->scores(view, likely);
  for (const std::size_t i : likely) EXPECT_EQ(a[i], b[i]);
  EXPECT_EQ(first(b), 120u);
}

TEST(LtmMatchScorer, SmallMapsAreMatchedWhole) {
  Large large(100);
  const auto exact = large.scorer(1000, 5), bounded = large.scorer(100, 5);
  const types::Features view = large.seenAgain(20, 20);
  EXPECT_EQ(exact->scores(view), bounded->scores(view));
}

/// The index of a growing map changes at images that do not depend on the time that learning takes, and it
/// knows every place at any time.
TEST(PlaceIndex, GrowsWithTheMap) {
  Views views;
  const auto places = someViews(views, 400);
  const auto source = [&](std::size_t i) { return places[i]; };
  PlaceIndex one(50), other(50);
  std::size_t readyAt = 0;
  for (std::size_t n = 0; n <= places.size(); ++n) {
    for (PlaceIndex* index : {&one, &other}) {
      if (n > 0) index->set(n - 1, places[n - 1]);
      index->settle(n, source);
    }
    ASSERT_EQ(one.ready(), other.ready()) << n;
    if (!one.ready()) continue;
    if (readyAt == 0) readyAt = n;
    if (n % 13 != 0) continue;
    const std::size_t shown = n * 2 / 3;
    const types::Features view = views.again(places[shown], 30);
    const auto votes = one.votes(view);
    ASSERT_EQ(votes, other.votes(view)) << n;
    ASSERT_EQ(votes.size(), n);
    EXPECT_EQ(first(votes), shown) << n;
  }
  EXPECT_GE(readyAt, 71u);
  EXPECT_LE(readyAt, 80u);
}

TEST(PlaceIndex, IsMadeAtOnceForAWholeMap) {
  Views views;
  const auto places = someViews(views, 60);
  PlaceIndex index(50), none(60);
  const auto source = [&](std::size_t i) { return places[i]; };
  index.settle(60, source);
  none.settle(60, source);
  ASSERT_TRUE(index.ready());
  EXPECT_FALSE(none.ready());
  EXPECT_EQ(first(index.votes(views.again(places[33], 30))), 33u);
}

/// What was laid beside a map, in memory.
class Beside : public map::Derived {
 public:
  explicit Beside(std::vector<map::DerivedRow> given) : rows(std::move(given)) {}
  void read(map::DerivedKind kind, const Take& take) const override {
    for (const map::DerivedRow& row : rows)
      if (row.kind == kind) take(row.id, row.data);
  }
  std::vector<map::DerivedRow> rows;
};

std::uint32_t sameNumber(std::size_t place) { return static_cast<std::uint32_t>(place); }
std::optional<std::size_t> samePlace(std::uint32_t id) { return id; }

TEST(PlaceIndex, IsTheSameAfterItWasLaidBesideTheMap) {
  Views views;
  auto places = someViews(views, 120);
  const auto source = [&](std::size_t i) { return places[i]; };
  PlaceIndex made(50);
  made.settle(100, source);
  for (std::size_t i = 100; i < 120; ++i) made.set(i, places[i]);
  made.settle(120, source);
  const Beside beside(made.changes(sameNumber));
  ASSERT_EQ(beside.rows.size(), 121u);
  EXPECT_TRUE(made.changes(sameNumber).empty()) << "all of it was";
  PlaceIndex restored(50);
  const auto sizes = restored.restore(beside, 120, samePlace);
  ASSERT_EQ(sizes.size(), 120u);
  for (const auto& [place, size] : sizes) EXPECT_EQ(size, kFeatures) << place;
  EXPECT_TRUE(restored.changes(sameNumber).empty());
  for (int k = 0; k < 20; ++k) {
    const types::Features view = views.again(places[views.rng().below(120)], 30);
    EXPECT_EQ(restored.votes(view), made.votes(view));
  }
  // A place that learns alone is laid there again.
  places[7] = views.make();
  for (PlaceIndex* index : {&made, &restored}) index->set(7, places[7]);
  ASSERT_EQ(restored.changes(sameNumber).size(), 1u);
  const types::Features view = views.again(places[7], 30);
  EXPECT_EQ(restored.votes(view), made.votes(view));
}

TEST(PlaceIndex, MissingRowsAreMissedAlone) {
  Views views;
  const auto places = someViews(views, 60);
  const auto source = [&](std::size_t i) { return places[i]; };
  PlaceIndex made(50);
  made.settle(60, source);
  Beside beside(made.changes(sameNumber));
  PlaceIndex unneeded(60), other(50);
  EXPECT_TRUE(unneeded.restore(beside, 60, samePlace).empty());
  EXPECT_FALSE(unneeded.ready());
  std::erase_if(beside.rows, [](const map::DerivedRow& row) {
    return row.kind == map::DerivedKind::kPlaceWords && row.id == 3;
  });
  const std::size_t known = other.restore(beside, 60, samePlace).size();
  EXPECT_EQ(known, 59u);
  other.set(3, places[3]);
  const types::Features view = views.again(places[3], 30);
  EXPECT_EQ(other.votes(view), made.votes(view));
  beside.rows.erase(beside.rows.begin());  // the words
  PlaceIndex none(50);
  EXPECT_TRUE(none.restore(beside, 60, samePlace).empty());
  EXPECT_FALSE(none.ready());
}

TEST(PlaceIndex, RefusesRowsOfOtherWords) {
  Views views;
  const auto places = someViews(views, 60), others = someViews(views, 60);
  PlaceIndex one(50), two(50);
  one.settle(60, [&](std::size_t i) { return places[i]; });
  two.settle(60, [&](std::size_t i) { return others[i]; });
  Beside mixed(one.changes(sameNumber));
  const auto rows = two.changes(sameNumber);
  std::copy(rows.begin() + 31, rows.end(), mixed.rows.begin() + 31);
  EXPECT_EQ(PlaceIndex(50).restore(mixed, 60, samePlace).size(), 30u);
}

TEST(PlaceRows, RefuseWhatIsCutOff) {
  Views views;
  const PlaceWords words = PlaceWords::train(together(someViews(views, 10)), 1);
  const auto vocabulary = encodeVocabulary(words, 77);
  EXPECT_EQ(decodeVocabulary(vocabulary).learnAt, 77u);
  EXPECT_EQ(decodeVocabulary(vocabulary).words.tag(), words.tag());
  auto place = encodeWords({words.tag(), {{3, 1}, {3, 2}, {900, ~std::uint64_t{0}}}});
  EXPECT_EQ(decodeWords(place).words, (std::vector<PlaceWord>{{3, 1}, {3, 2}, {900, ~std::uint64_t{0}}}));
  for (std::size_t n = 0; n < place.size(); ++n)
    EXPECT_THROW(decodeWords(std::span(place).first(n)), base::Error) << n;
  for (std::size_t n = 0; n < vocabulary.size(); n += 97)
    EXPECT_THROW(decodeVocabulary(std::span(vocabulary).first(n)), base::Error) << n;
  place[0] = 2;
  EXPECT_THROW(decodeWords(place), base::Error);
}

/// Places that lie in a file are matched as those that are here.
TEST(LtmMatchScorer, OpensAMapWithoutItsMemories) {
  class File : public map::OnDemand<memory::PlaceMemory>::Source {
   public:
    explicit File(const map::TopologicalMap& map) : map_(map) {}
    memory::PlaceMemory read(std::uint32_t id) const override {
      ++reads;
      return *map_.place(base::PlaceId(id)).memory;
    }
    mutable int reads = 0;

   private:
    const map::TopologicalMap& map_;
  };
  Large large(300);
  const auto here = large.scorer(100, 20);
  const auto file = std::make_shared<File>(large.map);
  map::MapContent content = large.map.content();
  for (auto& [id, place] : content.places) place.memory = {file, id.value};
  content.derived = std::make_shared<Beside>(here->changes());
  const map::TopologicalMap opened(std::move(content));
  PipelineParams params;
  params.recognise.exhaustive_places = 100;
  params.recognise.proposals = 20;
  const auto scorer = makeScorer(params);
  std::vector<base::PlaceId> ids;
  for (const auto& [id, place] : opened.places()) ids.push_back(id);
  scorer->load(opened, ids);
  EXPECT_EQ(file->reads, 0);
  for (const std::size_t shown : {17, 170}) {
    const types::Features view = large.seenAgain(shown, 20);
    EXPECT_EQ(scorer->scores(view), here->scores(view));
    EXPECT_LT(file->reads, 2 * (20 + 48));
  }
  EXPECT_TRUE(scorer->changes().empty());
}

}  // namespace
}  // namespace engram::pipeline

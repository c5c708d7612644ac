// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/bag_of_words.h"

#include "make_descriptors.h"
#include "tf_idf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace engram::vocabulary {
namespace {

using base::PlaceId;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(TfIdf, IsTheTableOfEquationTwelve) {
  // Words by image; word 3 is in all of them, word 4 in none, the last image is empty.
  const std::vector<std::vector<int>> images{{0, 0, 1, 3}, {1, 3}, {1, 2, 2, 2, 3, 3}, {3}};
  std::vector<Eigen::VectorXd> counts;
  for (const auto& words : images) counts.push_back(countWords(words, 5));
  const auto idf = inverseDocumentFrequency(counts, 5);
  const double ln4 = std::log(4.0), ln43 = std::log(4.0 / 3.0);
  EXPECT_THAT(std::vector<double>(idf.begin(), idf.end()), ElementsAre(ln4, ln43, ln4, 0.0, 0.0));

  const auto table = [&](std::size_t i) {
    const auto v = tfIdf(counts[i], idf);
    return std::vector<double>(v.begin(), v.end());
  };
  EXPECT_THAT(table(0), ElementsAre(2.0 / 4 * ln4, 1.0 / 4 * ln43, 0.0, 0.0, 0.0));
  EXPECT_THAT(table(1), ElementsAre(0.0, 1.0 / 2 * ln43, 0.0, 0.0, 0.0));
  EXPECT_THAT(table(2), ElementsAre(0.0, 1.0 / 6 * ln43, 3.0 / 6 * ln4, 0.0, 0.0));
  EXPECT_THAT(table(3), Each(0.0));
  EXPECT_TRUE(tfIdf(countWords({}, 5), idf).isZero(0));
}

TEST(CosineSimilarity, IsTheCosineAndZeroForNothing) {
  EXPECT_NEAR(cosineSimilarity(Eigen::Vector2d(1, 0), Eigen::Vector2d(3, 4)), 0.6, 1e-15);
  EXPECT_NEAR(cosineSimilarity(Eigen::Vector2d(2, 1), Eigen::Vector2d(2, 1)), 1.0, 1e-15);
  EXPECT_EQ(cosineSimilarity(Eigen::Vector2d(0, 0), Eigen::Vector2d(3, 4)), 0.0);
}

/// An image of `n` descriptors near each of the given axes.
types::Descriptors image(const std::vector<int>& axes, int n, base::Rng& rng) {
  std::vector<std::vector<float>> rows;
  for (const int axis : axes)
    for (int i = 0; i < n; ++i) {
      std::vector<float> row(16);
      for (float& c : row) c = static_cast<float>(rng.normal(0, 0.01));
      row[static_cast<std::size_t>(axis)] += 0.9f;
      rows.push_back(row);
    }
  return floatDescriptors(rows);
}

struct Walk {
  std::vector<types::Descriptors> images;
  std::vector<BagOfWords::View> views;
};

/// Place p shows the axes p, p + 1 and 15; two views of each.
Walk walk(base::Rng& rng) {
  Walk w;
  for (int v = 0; v < 20; ++v) w.images.push_back(image({v / 2, v / 2 + 1, 15}, 6, rng));
  for (int v = 0; v < 20; ++v)
    w.views.push_back({PlaceId(static_cast<std::uint32_t>(v / 2)), &w.images[static_cast<std::size_t>(v)]});
  return w;
}

TEST(BagOfWords, RanksTheRightPlaceFirst) {
  base::Rng rng(1);
  const auto w = walk(rng);
  BagOfWords bow({});
  bow.rebuild(w.views);
  ASSERT_EQ(bow.size(), 20u);
  for (int p = 0; p < 10; ++p) {
    const auto scores = bow.score(image({p, p + 1, 15}, 6, rng));
    const auto best =
        static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
    EXPECT_EQ(bow.placeOf(best), PlaceId(static_cast<std::uint32_t>(p)));
    for (const double s : scores) {
      EXPECT_GE(s, 0.0);
      EXPECT_LE(s, 1.0);
    }
  }
  EXPECT_GT(bow.bytes(), 20 * 80 * sizeof(float));
}

TEST(BagOfWords, ScoresByItsDefinition) {
  base::Rng rng(2);
  const auto w = walk(rng);
  BowParams params;
  params.words = 12;
  BagOfWords bow(params);
  bow.rebuild(w.views);
  const auto query = types::quantised(image({4, 7, 15, 2}, 5, rng));
  const auto scores = bow.score(query);

  std::vector<const types::Descriptors*> images;
  for (const auto& d : w.images) images.push_back(&d);
  const KMeansDictionary dictionary(images, params);
  std::vector<Eigen::VectorXd> counts;
  for (const auto* d : images) counts.push_back(countWords(dictionary.wordsOf(*d), 12));
  const auto idf = inverseDocumentFrequency(counts, 12);
  const auto q = tfIdf(countWords(dictionary.wordsOf(query), 12), idf);
  for (std::size_t v = 0; v < scores.size(); ++v)
    EXPECT_EQ(scores[v], cosineSimilarity(q, tfIdf(counts[v], idf))) << v;

  BagOfWords again(params);
  again.rebuild(w.views);
  EXPECT_EQ(again.score(query), scores);
}

TEST(BagOfWords, ForgetsTheOldViewsWhenRebuilt) {
  base::Rng rng(3);
  const auto w = walk(rng);
  BagOfWords bow({}), fresh({});
  bow.rebuild(w.views);
  const std::span<const BagOfWords::View> few(w.views.data() + 4, 6);
  bow.rebuild(few);
  fresh.rebuild(few);
  EXPECT_EQ(bow.size(), 6u);
  EXPECT_EQ(bow.placeOf(0), PlaceId(2));
  EXPECT_EQ(bow.score(w.images[5]), fresh.score(w.images[5]));
}

TEST(BagOfWords, LivesWithEmptyImages) {
  base::Rng rng(4);
  auto w = walk(rng);
  const types::Descriptors empty(types::DescriptorKind::kFloat, 16), none;
  w.views.push_back({PlaceId(10), &empty});
  BagOfWords bow({});
  EXPECT_TRUE(bow.score(w.images[0]).empty());
  bow.rebuild(w.views);
  EXPECT_THAT(bow.score(empty), Each(0.0));
  EXPECT_EQ(bow.score(w.images[0]).back(), 0.0);
  EXPECT_GT(bow.score(w.images[0]).front(), 0.9);

  const BagOfWords::View nothing[] = {{PlaceId(0), &empty}, {PlaceId(1), &none}};
  bow.rebuild(nothing);
  EXPECT_THAT(bow.score(w.images[0]), ElementsAre(0.0, 0.0));
  bow.rebuild({});
  EXPECT_EQ(bow.size(), 0u);
}

TEST(BagOfWords, RefusesBinaryDescriptors) {
  types::Descriptors binary(types::DescriptorKind::kBinary, 256);
  binary.resize(20);
  const BagOfWords::View view[] = {{PlaceId(0), &binary}};
  BagOfWords bow({});
  EXPECT_THAT([&] { bow.rebuild(view); }, ThrowsMessage<base::Error>(HasSubstr("surf or sift")));
}

}  // namespace
}  // namespace engram::vocabulary

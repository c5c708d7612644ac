// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/kmeans_dictionary.h"

#include "make_descriptors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <limits>
#include <set>

namespace engram::vocabulary {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

KMeansDictionary train(const types::Descriptors& d, const BowParams& params = {}) {
  const types::Descriptors* images[] = {&d};
  return {images, params};
}

/// Noisy copies of the axes of a space of 8 dimensions: blob b is 0.9 e_b.
types::Descriptors blobs(int perBlob, base::Rng& rng) {
  std::vector<std::vector<float>> rows;
  for (int i = 0; i < 8 * perBlob; ++i) {
    std::vector<float> row(8);
    for (float& c : row) c = static_cast<float>(rng.normal(0, 0.01));
    row[static_cast<std::size_t>(i % 8)] += 0.9f;
    rows.push_back(row);
  }
  return floatDescriptors(rows);
}

int nearestByBruteForce(const KMeansDictionary& dictionary, const types::Descriptors& d, std::size_t i) {
  double best = std::numeric_limits<double>::infinity();
  int word = -1;
  for (int w = 0; w < dictionary.size(); ++w) {
    double squares = 0;
    for (int c = 0; c < d.dim(); ++c) {
      const float x = d.kind() == types::DescriptorKind::kFloat
                          ? d.floats(i)[c]
                          : static_cast<float>(d.int8(i)[c]) / types::kInt8Scale;
      const double difference = static_cast<double>(x) - static_cast<double>(dictionary.centres()(w, c));
      squares += difference * difference;
    }
    if (squares < best) {
      best = squares;
      word = w;
    }
  }
  return word;
}

TEST(KMeansDictionary, FindsTheCentresOfSeparateBlobs) {
  base::Rng rng(1);
  const auto d = blobs(200, rng);
  for (const auto& input : {d, types::quantised(d)}) {
    BowParams params;
    params.words = 8;
    // k-means may end in a local minimum from one start in several; any of a few must find the blobs.
    bool found = false;
    for (params.seed = 1; params.seed <= 5 && !found; ++params.seed) {
      const auto dictionary = train(input, params);
      ASSERT_EQ(dictionary.size(), 8);
      std::set<Eigen::Index> axes;
      double worst = 0;
      for (int w = 0; w < 8; ++w) {
        Eigen::Index axis = 0;
        dictionary.centres().row(w).maxCoeff(&axis);
        axes.insert(axis);
        Eigen::RowVectorXf truth = Eigen::RowVectorXf::Zero(8);
        // A quantised component saturates at 127 / 254.
        truth[axis] = input.kind() == types::DescriptorKind::kFloat ? 0.9f : 0.5f;
        worst = std::max<double>(worst, (dictionary.centres().row(w) - truth).norm());
      }
      found = axes.size() == 8 && worst < 0.005;
    }
    EXPECT_TRUE(found);
  }
}

TEST(KMeansDictionary, QuantisesToTheNearestCentre) {
  base::Rng rng(2);
  BowParams params;
  params.words = 200;
  params.iterations = 3;
  const auto dictionary = train(randomFloats(3000, 64, rng), params);
  const auto queries = randomFloats(600, 64, rng);
  for (const auto& input : {queries, types::quantised(queries)}) {
    const auto words = dictionary.wordsOf(input);
    ASSERT_EQ(words.size(), 600u);
    for (std::size_t i = 0; i < words.size(); ++i)
      ASSERT_EQ(words[i], nearestByBruteForce(dictionary, input, i)) << i;
  }
}

TEST(KMeansDictionary, GivesTheLowerNumberOnATie) {
  // Three equal descriptors and three words: the centres coincide.
  const auto dictionary = train(floatDescriptors({{1, 0}, {1, 0}, {1, 0}}));
  EXPECT_EQ(dictionary.size(), 3);
  EXPECT_EQ(dictionary.wordsOf(floatDescriptors({{0, 1}})), std::vector<int>{0});
}

TEST(KMeansDictionary, DependsOnTheSeedOnly) {
  base::Rng rng(3);
  const auto d = randomFloats(2000, 32, rng);
  BowParams params;
  params.max_training = 500;
  const auto first = train(d, params).centres();
  cv::theRNG() = cv::RNG(4711);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto alone = train(d, params).centres();
  const auto drawn = cv::theRNG()();
  cv::setNumThreads(3);
  EXPECT_EQ(train(d, params).centres(), alone);
  cv::setNumThreads(threads);
  EXPECT_EQ(alone, first);
  EXPECT_EQ(cv::RNG(4711)(), drawn) << "the caller's generator has moved";
  params.seed = 2;
  EXPECT_NE(train(d, params).centres(), first);
}

TEST(KMeansDictionary, TrainsOnNoMoreThanItMay) {
  // 10 of 4000 are drawn, and each becomes a word: the words are among the descriptors.
  base::Rng rng(4);
  const auto d = randomFloats(4000, 16, rng);
  BowParams params;
  params.max_training = 10;
  const auto dictionary = train(d, params);
  ASSERT_EQ(dictionary.size(), 10);
  std::set<std::size_t> drawn;
  for (int w = 0; w < 10; ++w)
    for (std::size_t i = 0; i < d.size(); ++i)
      if (std::equal(d.floats(i), d.floats(i) + 16, dictionary.centres().row(w).data())) drawn.insert(i);
  EXPECT_EQ(drawn.size(), 10u);
  EXPECT_GT(*drawn.rbegin(), 1000u) << "not only the first";
}

TEST(KMeansDictionary, RefusesWhatItCannotUse) {
  types::Descriptors binary(types::DescriptorKind::kBinary, 256);
  binary.resize(20);
  EXPECT_THAT([&] { train(binary); },
              ThrowsMessage<base::Error>(HasSubstr("choose an extractor with float")));
  EXPECT_THAT([&] { train({}); }, ThrowsMessage<base::Error>(HasSubstr("no descriptors")));
  base::Rng rng(5);
  const auto small = randomFloats(3, 8, rng), large = randomFloats(3, 16, rng);
  const types::Descriptors* mixed[] = {&small, &large};
  EXPECT_THAT([&] { KMeansDictionary(mixed, {}); },
              ThrowsMessage<base::Error>(HasSubstr("descriptors of 8 and of 16 components")));
  const auto dictionary = train(small);
  EXPECT_THAT([&] { dictionary.wordsOf(large); },
              ThrowsMessage<base::Error>(HasSubstr("words of 8 components")));
  EXPECT_THAT([&] { dictionary.wordsOf(binary); }, ThrowsMessage<base::Error>(HasSubstr("binary")));
  EXPECT_TRUE(dictionary.wordsOf({}).empty());
  BowParams params;
  params.words = 0;
  EXPECT_THAT([&] { train(small, params); }, ThrowsMessage<base::ConfigError>(HasSubstr("words: 0")));
}

}  // namespace
}  // namespace engram::vocabulary

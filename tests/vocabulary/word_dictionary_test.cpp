// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/word_dictionary.h"

#include "engram/base/config.h"
#include "make_descriptors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <stdexcept>

namespace engram::vocabulary::dictionary {
namespace {

using base::WordId;
using testing::Each;
using testing::HasSubstr;
using testing::ThrowsMessage;
using types::DescriptorKind;
using types::Descriptors;

struct Layout {
  const char* name;
  DescriptorKind kind;
  int dim;
};

/// Thresholds that tell rows seen again from others; small nodes, so that few words make a deep tree.
WordParams smallNodes(int checks) {
  WordParams p;
  p.max_distance = 0.4;
  p.max_bits = 0.15;
  p.leaf_size = 8;
  p.branching = 4;
  p.checks = checks;
  return p;
}

double threshold(DescriptorKind kind, const WordParams& p) {
  return kind == DescriptorKind::kBinary ? p.max_bits : p.max_distance;
}

/// A plain list of words, searched one by one.
struct Oracle {
  std::map<std::uint32_t, std::pair<const Descriptors*, std::size_t>> words;

  std::pair<std::uint32_t, double> nearest(const Descriptors& d, std::size_t i) const {
    std::pair<std::uint32_t, double> best{WordId::kInvalid, std::numeric_limits<double>::infinity()};
    for (const auto& [id, row] : words) {
      const double distance = distanceOf(d, i, *row.first, row.second);
      if (distance < best.second) best = {id, distance};
    }
    return best;
  }
};

/// Half of the rows are new, half are earlier ones seen again.
Descriptors nextImage(const Layout& layout, const std::vector<Descriptors>& before, base::Rng& rng) {
  Descriptors d = randomRows(layout.kind, 20, layout.dim, rng);
  for (int i = 0; i < 20 && !before.empty(); ++i) {
    const auto& old = before[rng.below(static_cast<std::uint32_t>(before.size()))];
    appendSeenAgain(d, old, rng.below(static_cast<std::uint32_t>(old.size())),
                    layout.kind == DescriptorKind::kBinary ? 0.05 : 0.15, rng);
  }
  return d;
}

class Dictionary : public testing::TestWithParam<Layout> {};

TEST_P(Dictionary, AgreesWithBruteForceThroughGrowthAndRemoval) {
  base::Rng rng(1);
  const WordParams params = smallNodes(0);
  const double limit = threshold(GetParam().kind, params);
  WordDictionary dictionary(params);
  Oracle oracle;
  std::vector<Descriptors> images;
  images.reserve(60);  // the oracle points into it
  std::uint32_t next = 0;
  for (int k = 0; k < 60; ++k) {
    images.push_back(nextImage(GetParam(), images, rng));
    const Descriptors& image = images.back();
    const auto matches = dictionary.lookup(image);
    for (std::size_t i = 0; i < image.size() && !oracle.words.empty(); ++i) {
      const auto [word, distance] = oracle.nearest(image, i);
      ASSERT_NEAR(matches[i].distance, distance, 1e-5);
      ASSERT_EQ(matches[i].word, distance <= limit ? WordId(word) : WordId()) << distance;
    }
    const auto learnt = dictionary.learn(image, matches);
    Oracle made;
    for (std::size_t i = 0; i < image.size(); ++i) {
      if (matches[i].found()) {
        ASSERT_EQ(learnt[i], matches[i].word);
        continue;
      }
      const auto [word, distance] = made.nearest(image, i);
      ASSERT_EQ(learnt[i].value, distance <= limit ? word : next);
      if (learnt[i].value == next) made.words[next++] = {&image, i};
    }
    oracle.words.merge(made.words);
    // Now and then most words go, so that nodes empty and the tree loses height.
    const double share = k % 20 == 19 ? 0.95 : 0.1;
    for (auto w = oracle.words.begin(); w != oracle.words.end();) {
      if (rng.uniform() >= share) {
        ++w;
        continue;
      }
      dictionary.remove(WordId(w->first));
      EXPECT_FALSE(dictionary.contains(WordId(w->first)));
      w = oracle.words.erase(w);
    }
    ASSERT_EQ(dictionary.size(), oracle.words.size());
    ASSERT_EQ(dictionary.nextId(), next);
  }
  for (const auto& w : oracle.words) dictionary.remove(WordId(w.first));
  EXPECT_EQ(dictionary.size(), 0u);
  EXPECT_FALSE(dictionary.lookup(images[0])[0].found());
  EXPECT_EQ(dictionary.learn(images[0], dictionary.lookup(images[0]))[0], WordId(next)) << "ids start again";
}

TEST_P(Dictionary, FindsWordsSeenAgainWithFewComparisons) {
  base::Rng rng(2);
  const bool binary = GetParam().kind == DescriptorKind::kBinary;
  // Descriptors of images come in clusters; without any structure no search can be short.
  const auto centres = randomRows(GetParam().kind, 60, GetParam().dim, rng);
  WordParams params;
  params.max_distance = 0.3;
  params.max_bits = 0.1;
  params.checks = 800;
  WordDictionary dictionary(params);
  Descriptors words(GetParam().kind, GetParam().dim), queries = words;
  for (int k = 0; k < 20; ++k) {
    Descriptors image(GetParam().kind, GetParam().dim);
    for (int i = 0; i < 400; ++i) appendSeenAgain(image, centres, rng.below(60), binary ? 0.2 : 0.7, rng);
    dictionary.learn(image, dictionary.lookup(image));
    for (std::size_t i = 0; i < image.size(); ++i) words.append(image.row(i));
  }
  ASSERT_EQ(dictionary.size(), 8000u) << "the words must be far from each other";
  for (std::size_t i = 0; i < 400; ++i) appendSeenAgain(queries, words, 20 * i, binary ? 0.05 : 0.2, rng);
  int right = 0;
  const auto matches = dictionary.lookup(queries);
  for (std::size_t i = 0; i < 400; ++i)
    right += matches[i].word == WordId(static_cast<std::uint32_t>(20 * i));
  EXPECT_GE(right, 380) << "of 400, with a tenth of the comparisons";
}

TEST_P(Dictionary, IsDeterministic) {
  const auto grow = [&](int threads) {
    base::Rng rng(3);
    WordDictionary dictionary(smallNodes(40));
    std::vector<Descriptors> images;
    std::vector<std::vector<WordMatch>> all;
    for (int k = 0; k < 30; ++k) {
      images.push_back(nextImage(GetParam(), images, rng));
      all.push_back(dictionary.lookup(images.back(), threads));
      dictionary.learn(images.back(), all.back());
      if (k > 10)
        dictionary.remove(dictionary.lookup(images[5])[0].word.valid() ? dictionary.lookup(images[5])[0].word
                                                                       : WordId(dictionary.nextId() - 1));
    }
    return all;
  };
  const auto once = grow(1);
  EXPECT_EQ(grow(1), once);
  EXPECT_EQ(grow(3), once);
}

INSTANTIATE_TEST_SUITE_P(Layouts, Dictionary,
                         testing::Values(Layout{"float64", DescriptorKind::kFloat, 64},
                                         Layout{"float61", DescriptorKind::kFloat, 61},
                                         Layout{"int8_64", DescriptorKind::kInt8, 64},
                                         Layout{"int8_128", DescriptorKind::kInt8, 128},
                                         Layout{"bits256", DescriptorKind::kBinary, 256},
                                         Layout{"bits486", DescriptorKind::kBinary, 486}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(WordDictionary, StartsEmpty) {
  base::Rng rng(4);
  const WordDictionary dictionary({});
  EXPECT_EQ(dictionary.size(), 0u);
  EXPECT_THAT(dictionary.lookup(randomFloats(5, 64, rng)), Each(WordMatch{}));
  EXPECT_TRUE(dictionary.lookup({}).empty());
}

TEST(WordDictionary, HoldsManyEqualWordsOnlyOnce) {
  base::Rng rng(5);
  const auto one = randomRows(DescriptorKind::kInt8, 1, 64, rng);
  Descriptors many(DescriptorKind::kInt8, 64);
  for (int i = 0; i < 300; ++i) many.append(one.row(0));
  WordDictionary dictionary(smallNodes(0));
  EXPECT_THAT(dictionary.learn(many, dictionary.lookup(many)), Each(WordId(0)));
  EXPECT_THAT(dictionary.learn(many, dictionary.lookup(many)), Each(WordId(0)));
}

TEST(WordDictionary, SplitsNodesOfEqualWords) {
  base::Rng rng(6);
  const auto one = randomRows(DescriptorKind::kInt8, 1, 64, rng);
  WordDictionary dictionary(smallNodes(0));
  for (int i = 0; i < 100; ++i) dictionary.learn(one, std::vector<WordMatch>(1));  // as if nothing was found
  EXPECT_EQ(dictionary.size(), 100u);
  EXPECT_EQ(dictionary.lookup(one)[0], (WordMatch{WordId(0), 0.0f})) << "ties: the lower id";
}

TEST(WordDictionary, QuantisesFloatsForWordsOfBytes) {
  base::Rng rng(7);
  const auto floats = randomFloats(50, 64, rng);
  WordDictionary dictionary({});
  dictionary.learn(types::quantised(floats), std::vector<WordMatch>(50));
  const auto matches = dictionary.lookup(floats);
  EXPECT_EQ(matches, dictionary.lookup(types::quantised(floats)));
  EXPECT_EQ(dictionary.learn(floats, matches)[49], WordId(49));
  EXPECT_EQ(dictionary.kind(), DescriptorKind::kInt8);
}

TEST(WordDictionary, RefusesWhatDoesNotFit) {
  base::Rng rng(8);
  const auto floats = randomFloats(3, 64, rng);
  WordDictionary dictionary({});
  const auto words = dictionary.learn(floats, dictionary.lookup(floats));
  EXPECT_THAT([&] { dictionary.lookup(types::quantised(floats)); },
              ThrowsMessage<base::Error>(HasSubstr("words of 64 floats, the image descriptors of 64 bytes")));
  EXPECT_THAT([&] { dictionary.lookup(randomBits(3, 256, rng)); },
              ThrowsMessage<base::Error>(HasSubstr("use the extractor")));
  EXPECT_THROW(dictionary.learn(randomFloats(3, 32, rng), std::vector<WordMatch>(3)), base::Error);
  EXPECT_THROW(dictionary.learn(floats, {}), std::invalid_argument);
  const auto matches = dictionary.lookup(floats);
  dictionary.remove(words[1]);
  EXPECT_THROW(dictionary.learn(floats, matches), std::invalid_argument);
  EXPECT_THROW(dictionary.remove(words[1]), std::invalid_argument);
  WordParams params;
  params.leaf_size = 1;
  EXPECT_THAT([&] { WordDictionary{params}; }, ThrowsMessage<base::ConfigError>(HasSubstr("leaf_size: 1")));
}

TEST(WordParams, ReadsItsOwnDump) {
  WordParams params, read;
  params.max_distance = 0.35;
  params.checks = 77;
  base::Config config, config2;
  config.bind("words", params);
  config2.bind("words", read);
  config2.read(base::IniFile::parse(config.dump(), "dump"));
  EXPECT_EQ(read, params);
}

}  // namespace
}  // namespace engram::vocabulary::dictionary

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/vocabulary_tree.h"

#include "engram/base/error.h"
#include "make_descriptors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <unistd.h>
#include <zlib.h>

namespace engram::vocabulary {
namespace {

using base::WordId;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;
using types::DescriptorKind;
using types::Descriptors;

VocabularyTree trainOn(const Descriptors& rows, const TreeParams& params = {}) {
  const Descriptors* images[] = {&rows};
  return VocabularyTree::train(images, params);
}

class Tree : public testing::TestWithParam<DescriptorKind> {
 protected:
  int dim() const { return GetParam() == DescriptorKind::kBinary ? 256 : 64; }
  Descriptors random(int n) { return randomRows(GetParam(), n, dim(), rng); }
  Descriptors seenAgain(const Descriptors& rows, int times) {
    Descriptors out(rows.kind(), rows.dim());
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (int k = 0; k < times; ++k)
        appendSeenAgain(out, rows, i, GetParam() == DescriptorKind::kBinary ? 0.05 : 0.2, rng);
    return out;
  }
  base::Rng rng{1};
};

/// k-means in one level: rows around far centres. k-means++ may put two into one cluster, seldom.
TEST_P(Tree, FindsTheClustersThatThereAre) {
  const auto centres = random(16);
  TreeParams params;
  params.branching = 16;
  params.depth = 1;
  const auto tree = trainOn(seenAgain(centres, 40), params);
  EXPECT_LE(tree.words(), 16u);
  const auto words = tree.wordsOf(centres), again = tree.wordsOf(seenAgain(centres, 10));
  EXPECT_GE(std::set(words.begin(), words.end()).size(), 13u);
  int same = 0;
  for (std::size_t i = 0; i < again.size(); ++i) same += again[i] == words[i / 10] ? 1 : 0;
  EXPECT_GE(same, 150);
}

/// A tree that grew until every leaf holds one row: its word is that of the nearest row, found by brute force
/// when the beam is wide, and mostly when it is not.
TEST_P(Tree, BeamTradesWorkForTheNearestLeaf) {
  const auto rows = random(300);
  const auto queries = seenAgain(rows, 1);
  std::vector<std::size_t> nearest;
  for (std::size_t q = 0; q < queries.size(); ++q) {
    double best = std::numeric_limits<double>::infinity();
    nearest.push_back(0);
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (const double d = distanceOf(queries, q, rows, i); d < best) best = d, nearest.back() = i;
  }
  std::vector<int> found;
  for (const int beam : {1, 3, 1000}) {
    TreeParams params;
    params.branching = 5;
    params.depth = 20;
    params.min_split = 2;
    params.beam = beam;
    const auto tree = trainOn(rows, params);
    const auto leaves = tree.wordsOf(rows), words = tree.wordsOf(queries);
    if (beam == 1000) {
      EXPECT_EQ(tree.words(), 300u);
      EXPECT_EQ(std::set(leaves.begin(), leaves.end()).size(), 300u);
    }
    int right = 0;
    for (std::size_t q = 0; q < queries.size(); ++q) right += words[q] == leaves[nearest[q]] ? 1 : 0;
    found.push_back(right);
  }
  EXPECT_LT(found[0], found[1]);
  EXPECT_LE(found[1], found[2]);
  EXPECT_EQ(found[2], 300);
}

TEST_P(Tree, DependsOnSeedAndDescriptorsOnly) {
  const auto rows = random(1500);
  TreeParams params;
  params.max_training = 500;
  const auto tree = trainOn(rows, params);
  EXPECT_EQ(trainOn(rows, params), tree);
  // The same rows as many images, some of them empty.
  std::vector<Descriptors> parts(16, Descriptors(rows.kind(), rows.dim()));
  for (std::size_t i = 0; i < rows.size(); ++i) parts[i / 100].append(rows.row(i));
  std::vector<const Descriptors*> images;
  for (const auto& part : parts) images.push_back(&part);
  EXPECT_EQ(VocabularyTree::train(images, params), tree);
  // A sample drawn now and trained on later.
  const auto sample = VocabularyTree::sample(images, params);
  EXPECT_EQ(sample.size(), 500u);
  EXPECT_EQ(trainOn(sample, params), tree);
  params.seed = 2;
  EXPECT_NE(trainOn(rows, params), tree);
}

TEST_P(Tree, StopsWhereThereIsNothingToSplit) {
  const auto one = random(1);
  auto tree = trainOn(one);
  EXPECT_EQ(tree.words(), 1u);
  EXPECT_THAT(tree.wordsOf(random(2)), ElementsAre(WordId(0), WordId(0)));
  EXPECT_THAT(tree.wordsOf(Descriptors()), IsEmpty());
  EXPECT_EQ(VocabularyTree::parse(tree.serialised()), tree);
  Descriptors equal(one.kind(), one.dim());
  for (int i = 0; i < 100; ++i) equal.append(one.row(0));
  EXPECT_EQ(trainOn(equal).words(), 1u);
  const auto other = random(1);
  for (int i = 0; i < 100; ++i) equal.append(other.row(0));
  tree = trainOn(equal);
  EXPECT_EQ(tree.words(), 2u);
  EXPECT_NE(tree.wordsOf(one), tree.wordsOf(other));
}

TEST_P(Tree, IsTheSameAfterReading) {
  const auto tree = trainOn(random(900));
  const auto read = VocabularyTree::parse(tree.serialised());
  EXPECT_EQ(read, tree);
  EXPECT_EQ(read.words(), tree.words());
  const auto queries = random(50);
  EXPECT_EQ(read.wordsOf(queries), tree.wordsOf(queries));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Tree,
                         testing::Values(DescriptorKind::kFloat, DescriptorKind::kInt8,
                                         DescriptorKind::kBinary),
                         kindName);

TEST(VocabularyTree, ComparesFloatsAsBytesWhereBothOccur) {
  base::Rng rng(2);
  const auto floats = randomFloats(200, 64, rng);
  const auto bytes = types::quantised(randomFloats(200, 64, rng));
  const Descriptors* images[] = {&floats, &bytes};
  const auto tree = VocabularyTree::train(images, {});
  EXPECT_EQ(tree.kind(), DescriptorKind::kInt8);
  EXPECT_EQ(tree.wordsOf(floats), tree.wordsOf(types::quantised(floats)));
}

TEST(VocabularyTree, RefusesWhatItCannotUse) {
  base::Rng rng(3);
  const auto bits = randomBits(30, 256, rng);
  const auto bytes = types::quantised(randomFloats(30, 64, rng));
  const Descriptors* mixed[] = {&bits, &bytes};
  EXPECT_THAT([&] { VocabularyTree::train(mixed, {}); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr("256 bits"), HasSubstr("64 bytes"))));
  EXPECT_THAT([&] { VocabularyTree::train({}, {}); },
              ThrowsMessage<base::Error>(HasSubstr("no descriptors")));
  TreeParams params;
  params.branching = 256;
  EXPECT_THAT([&] { trainOn(bits, params); }, ThrowsMessage<base::ConfigError>(HasSubstr("branching")));
  const auto tree = trainOn(bits);
  EXPECT_THAT([&] { tree.wordsOf(bytes); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr("256 bits"), HasSubstr("64 bytes"))));
}

TEST(VocabularyTree, TellsHowFarItIsAndCanBeStopped) {
  base::Rng rng(4);
  const auto rows = types::quantised(randomFloats(2000, 64, rng));
  const Descriptors* images[] = {&rows};
  std::vector<double> shares;
  const auto tree = VocabularyTree::train(images, {}, [&](double share) { shares.push_back(share); });
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.front(), 0);
  EXPECT_EQ(shares.back(), 1);
  EXPECT_EQ(tree, trainOn(rows));
  struct Stop {};
  EXPECT_THROW(VocabularyTree::train(images, {},
                                     [](double share) {
                                       if (share > 0) throw Stop();
                                     }),
               Stop);
}

/// A small tree of all kinds of nodes, as bytes.
std::vector<std::uint8_t> sample() {
  base::Rng rng(5);
  TreeParams params;
  params.branching = 3;
  params.min_split = 6;
  params.depth = 3;
  return trainOn(randomBits(60, 64, rng), params).serialised();
}

void seal(std::vector<std::uint8_t>& bytes) {
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &crc, 4);
}

/// The tree, or nothing when the bytes are refused with base::Error; anything else fails the test.
std::optional<VocabularyTree> tryParse(const std::vector<std::uint8_t>& bytes) {
  try {
    return VocabularyTree::parse(bytes);
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("the vocabulary cannot be read"));
    return {};
  }
}

TEST(VocabularyTreeBytes, AreRefusedWhenCutOrChanged) {
  const auto bytes = sample();
  ASSERT_TRUE(tryParse(bytes));
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(tryParse({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)})) << n;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int bit : {0, 3, 7}) {
      auto changed = bytes;
      changed[i] ^= static_cast<std::uint8_t>(1 << bit);
      EXPECT_FALSE(tryParse(changed)) << i;
    }
}

TEST(VocabularyTreeBytes, HoldFiniteCentres) {
  base::Rng rng(8);
  TreeParams params;
  params.branching = 3;
  auto bytes = trainOn(randomRows(DescriptorKind::kFloat, 40, 8, rng), params).serialised();
  ASSERT_TRUE(tryParse(bytes));
  const float bad = std::numeric_limits<float>::infinity();
  std::memcpy(bytes.data() + bytes.size() - 8, &bad, sizeof bad);
  seal(bytes);
  EXPECT_THAT([&] { VocabularyTree::parse(bytes); },
              ThrowsMessage<base::Error>(HasSubstr("its descriptors are not finite")));
}

TEST(VocabularyTreeBytes, AreReadSafelyWithARightChecksumToo) {
  const auto bytes = sample();
  base::Rng rng(6);
  int refused = 0;
  for (std::size_t i = 0; i + 4 < bytes.size(); ++i)
    for (const int flip : {0x01, 0x02, 0x80, 0xff, 0x40}) {
      auto changed = bytes;
      changed[i] ^= static_cast<std::uint8_t>(flip);
      seal(changed);
      const auto read = tryParse(changed);
      if (!read) {
        ++refused;
        continue;
      }
      // What is accepted must be whole: every word can be met, and none beyond.
      EXPECT_EQ(VocabularyTree::parse(read->serialised()), *read);
      for (const auto word : read->wordsOf(randomRows(read->kind(), 20, read->dim(), rng)))
        EXPECT_LT(word.value, read->words());
    }
  EXPECT_GT(refused, 60);
  for (std::size_t n = 4; n < bytes.size(); ++n) {
    std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    seal(cut);
    EXPECT_FALSE(tryParse(cut)) << n;
  }
}

TEST(VocabularyTreeBytes, TellWhatIsWrong) {
  auto bytes = sample();
  bytes[6] = 2;
  seal(bytes);
  EXPECT_THAT([&] { VocabularyTree::parse(bytes); }, ThrowsMessage<base::Error>(HasSubstr("newer version")));
  bytes[0] = 'X';
  seal(bytes);
  EXPECT_THAT([&] { VocabularyTree::parse(bytes); }, ThrowsMessage<base::Error>(HasSubstr("something else")));
  bytes[20] ^= 1;
  EXPECT_THAT([&] { VocabularyTree::parse(bytes); }, ThrowsMessage<base::Error>(HasSubstr("checksum")));
}

TEST(VocabularyTreeFile, IsNamedInEveryMessage) {
  char folder[] = "/tmp/engram_vocabulary_XXXXXX";
  ASSERT_NE(mkdtemp(folder), nullptr);
  const std::string path = std::string(folder) + "/office.vocabulary";
  base::Rng rng(7);
  const auto tree = trainOn(randomBits(100, 256, rng));
  tree.save(path);
  EXPECT_EQ(VocabularyTree::load(path), tree);
  EXPECT_THAT([&] { tree.save(path); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr(path), HasSubstr("exists already"))));
  EXPECT_NO_THROW(tree.save(path, true));
  std::ofstream(path, std::ios::app) << "x";
  EXPECT_THAT([&] { VocabularyTree::load(path); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr(path), HasSubstr("checksum"))));
  EXPECT_THAT([&] { VocabularyTree::load(path + "x"); }, ThrowsMessage<base::Error>(HasSubstr(path + "x")));
  EXPECT_THAT([&] { VocabularyTree::load(folder); },
              ThrowsMessage<base::Error>(HasSubstr("cannot be opened")));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace engram::vocabulary

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/word_index.h"

#include "engram/belief/likelihood.h"
#include "make_descriptors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <stdexcept>
#include <zlib.h>

namespace engram::vocabulary {
namespace {

using base::PlaceId;
using base::ViewId;
using testing::HasSubstr;
using testing::ThrowsMessage;
using types::DescriptorKind;
using types::Descriptors;

WordParams smallNodes() {
  WordParams p;
  p.max_distance = 0.4;
  p.leaf_size = 8;
  p.branching = 4;
  p.checks = 60;
  return p;
}

/// What a camera sees at a place: its own rows and some that are everywhere.
Descriptors look(const Descriptors& rows, std::uint32_t place, base::Rng& rng) {
  Descriptors d(rows.kind(), rows.dim());
  const double sigma = rows.kind() == DescriptorKind::kBinary ? 0.04 : 0.15;
  for (std::size_t i = 0; i < 20; ++i) appendSeenAgain(d, rows, 20 * place + i, sigma, rng);
  for (std::size_t i = 0; i < 10; ++i) appendSeenAgain(d, rows, rows.size() - 1 - i, sigma, rng);
  return d;
}

void see(WordIndex& words, std::uint32_t place, std::uint32_t view, const Descriptors& d) {
  words.learn(PlaceId(place), ViewId(view), d, words.recognise(d).matches);
}

void expectInStep(const WordIndex& words) {
  std::set<base::WordId> seen;
  for (const auto& [id, view] : words.index().views())
    for (const auto& w : view.words) {
      seen.insert(w.word);
      ASSERT_TRUE(words.dictionary().contains(w.word));
    }
  EXPECT_EQ(seen.size(), words.dictionary().size());
}

class Words : public testing::TestWithParam<DescriptorKind> {
 protected:
  Descriptors rows(int n) {
    return randomRows(GetParam(), n, GetParam() == DescriptorKind::kBinary ? 256 : 64, rng);
  }
  base::Rng rng{1};
};

TEST_P(Words, RecognisesPlacesAfterOneLook) {
  const auto all = rows(40 * 20 + 10);
  WordIndex words({});
  for (std::uint32_t p = 0; p < 40; ++p) {
    const auto d = look(all, p, rng);
    EXPECT_TRUE(words.recognise(d).votes.empty()) << "recognition comes before learning";
    see(words, p, p, d);
  }
  for (std::uint32_t p = 0; p < 40; ++p) {
    const auto r = words.recognise(look(all, p, rng));
    ASSERT_FALSE(r.votes.empty());
    const auto best = std::max_element(r.votes.begin(), r.votes.end(),
                                       [](const Vote& a, const Vote& b) { return a.score < b.score; });
    EXPECT_EQ(best->place, PlaceId(p));
    EXPECT_GT(best->score, 0.5 * words.index().maxVote());
  }
}

TEST_P(Words, DropsWordsThatAreNowhereSeen) {
  const auto all = rows(12 * 20 + 10);
  WordIndex words(smallNodes());
  base::Rng choice(2);
  for (std::uint32_t k = 0; k < 200; ++k) {
    if (choice.uniform() < 0.6)
      see(words, choice.below(12), k, look(all, choice.below(12), rng));
    else if (choice.uniform() < 0.8)
      words.removeView(ViewId(choice.below(k + 1)));
    else
      words.removePlace(PlaceId(choice.below(12)));
    expectInStep(words);
  }
  const auto next = words.dictionary().nextId();
  for (std::uint32_t p = 0; p < 12; ++p) words.removePlace(PlaceId(p));
  EXPECT_EQ(words.dictionary().size(), 0u);
  see(words, 0, 1000, look(all, 0, rng));
  for (const auto& w : words.index().views().at(ViewId(1000)).words) EXPECT_GE(w.word.value, next);
}

TEST_P(Words, GoesOnAfterReadingAsIfNothingHadHappened) {
  const auto all = rows(12 * 20 + 10);
  WordIndex words(smallNodes());
  for (std::uint32_t k = 0; k < 40; ++k) {
    see(words, k % 12, k, look(all, k % 12, rng));
    if (k % 5 == 4) words.removeView(ViewId(k - 3));
  }
  const auto bytes = words.serialised();
  WordIndex read = WordIndex::parse(bytes);
  EXPECT_EQ(read.serialised(), bytes);
  EXPECT_EQ(read.dictionary().params(), words.dictionary().params());
  EXPECT_EQ(read.index(), words.index());
  for (std::uint32_t k = 40; k < 80; ++k) {
    const auto d = look(all, rng.below(12), rng);
    const auto a = words.recognise(d), b = read.recognise(d);
    ASSERT_EQ(a.matches, b.matches);
    ASSERT_EQ(a.votes, b.votes);
    for (WordIndex* w : {&words, &read}) {
      w->learn(PlaceId(k % 12), ViewId(k), d, a.matches);
      if (k % 7 == 0) w->removePlace(PlaceId(k % 5));
    }
    ASSERT_EQ(words.serialised(), read.serialised());
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Words,
                         testing::Values(DescriptorKind::kFloat, DescriptorKind::kInt8,
                                         DescriptorKind::kBinary),
                         kindName);

TEST(WordIndex, GivesVotesThatTheRuleOfTheFilterTakes) {
  // A-E11 does not see the scale of its scores, so that votes may be brought into [0, 1] by maxVote().
  base::Rng rng(6);
  const auto rows = randomFloats(6 * 20 + 10, 64, rng);
  WordIndex words({});
  for (std::uint32_t p = 0; p < 6; ++p) see(words, p, p, look(rows, p, rng));
  std::vector<double> raw(6, 0.0), scaled(6, 0.0);
  for (const Vote& v : words.recognise(look(rows, 2, rng)).votes) {
    raw[v.place.value] = v.score;
    scaled[v.place.value] = v.score / words.index().maxVote();
  }
  double mean = 0, variance = 0;
  for (const double s : raw) mean += s / 6;
  for (const double s : raw) variance += (s - mean) * (s - mean) / 6;
  const double sigma = std::sqrt(variance);
  belief::BeliefParams params;
  params.likelihood = "angeli";
  params.floor = 1e-12;
  const auto l = belief::likelihood(scaled, belief::Adjacency::fromEdges(6, {}), params);
  const double best = (raw[2] - sigma) / mean, novel = mean / sigma + 1;
  ASSERT_GT(best, novel);
  EXPECT_NEAR(l.newPlace, novel / best, 1e-9);
  EXPECT_EQ(l.places[2], 1.0);
  EXPECT_NEAR(l.places[0], 1 / best, 1e-9);
}

TEST(WordIndex, LeavesAllAsItWasWhenItRefuses) {
  base::Rng rng(3);
  const auto d = randomFloats(10, 64, rng), other = randomFloats(10, 64, rng);
  WordIndex words({});
  see(words, 0, 0, d);
  const auto bytes = words.serialised();
  const auto matches = words.recognise(other).matches;
  EXPECT_THROW(words.learn(PlaceId(1), ViewId(0), other, matches), std::invalid_argument);
  EXPECT_THROW(words.learn(PlaceId(), ViewId(1), other, matches), std::invalid_argument);
  EXPECT_THROW(words.learn(PlaceId(1), ViewId(1), other, {}), std::invalid_argument);
  EXPECT_EQ(words.serialised(), bytes);
}

TEST(WordIndex, KeepsAnEmptyImageAndAnEmptyMap) {
  WordIndex words(smallNodes());
  EXPECT_EQ(WordIndex::parse(words.serialised()).serialised(), words.serialised());
  see(words, 4, 7, {});
  EXPECT_EQ(words.index().places(), 1u);
  const auto read = WordIndex::parse(words.serialised());
  EXPECT_EQ(read.index(), words.index());
}

/// A small index of two kinds of nodes, as bytes.
std::vector<std::uint8_t> sample() {
  base::Rng rng(4);
  WordIndex words(smallNodes());
  for (std::uint32_t v = 0; v < 4; ++v) see(words, v / 2, 3 * v, randomBits(9, 64, rng));
  return words.serialised();
}

/// Puts the right checksum on damaged bytes, so that the reader's own checks are tested.
void seal(std::vector<std::uint8_t>& bytes) {
  const auto crc = static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &crc, 4);
}

/// The index, or nothing when the bytes are refused with base::Error; anything else fails the test.
std::optional<WordIndex> tryParse(const std::vector<std::uint8_t>& bytes) {
  try {
    return WordIndex::parse(bytes);
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("the word index cannot be read"));
    return {};
  }
}

TEST(WordIndexBytes, AreRefusedWhenCutOrChanged) {
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

TEST(WordIndexBytes, AreReadSafelyWithARightChecksumToo) {
  const auto bytes = sample();
  base::Rng rng(5);
  const auto query = randomBits(5, 64, rng);
  int refused = 0;
  for (std::size_t i = 0; i + 4 < bytes.size(); ++i)
    for (const int flip : {0x01, 0x80, 0xff, 0x40}) {
      auto changed = bytes;
      changed[i] ^= static_cast<std::uint8_t>(flip);
      seal(changed);
      auto read = tryParse(changed);
      if (!read) {
        ++refused;
        continue;
      }
      // What is accepted must be whole: it can be searched, written and emptied.
      expectInStep(*read);
      if (read->dictionary().dim() == 64 && read->dictionary().kind() == DescriptorKind::kBinary)
        read->recognise(query);
      EXPECT_EQ(WordIndex::parse(read->serialised()).serialised(), read->serialised());
      const auto views = read->index().views();
      for (const auto& [id, view] : views) read->removeView(id);
      EXPECT_EQ(read->dictionary().size(), 0u);
    }
  EXPECT_GT(refused, 100);
  for (std::size_t n = 4; n < bytes.size(); ++n) {
    std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    seal(cut);
    EXPECT_FALSE(tryParse(cut)) << n;
  }
}

/// One binary word of 64 bits, or one of a float, in the tree that `nodes` says.
std::vector<std::uint8_t> withTree(DescriptorKind kind, std::uint8_t dim,
                                   const std::vector<std::uint8_t>& nodes) {
  const auto head = sample();
  std::vector<std::uint8_t> bytes(head.begin(), head.begin() + 7 + 1 + 16 + 3);  // magic, version, parameters
  bytes.insert(bytes.end(), {static_cast<std::uint8_t>(kind), dim, 2, 1});
  bytes.insert(bytes.end(), nodes.begin(), nodes.end());
  bytes.insert(bytes.end(), {1, 0, 0, 2, 0, 1, 0, 1});  // one view of place 0 that has words 0 and 1
  bytes.resize(bytes.size() + 4);
  seal(bytes);
  return bytes;
}

TEST(WordIndexBytes, HoldTreesThatASearchCanGoDown) {
  const auto binary = [](const std::vector<std::vector<std::uint8_t>>& nodes) {
    std::vector<std::uint8_t> bytes;
    for (const auto& node : nodes) {
      bytes.insert(bytes.end(), node.begin(), node.end());
      bytes.resize(bytes.size() + 8u * node[1]);
    }
    return withTree(DescriptorKind::kBinary, 64, bytes);
  };
  EXPECT_TRUE(tryParse(binary({{0, 2}, {1, 1, 0}, {1, 1, 1}})));
  EXPECT_THAT(
      [&] {
        WordIndex::parse(binary({{0, 2}, {0, 1}, {1, 1, 0}, {1, 1, 1}}));
      },
      ThrowsMessage<base::Error>(HasSubstr("its tree is not balanced")));
  std::vector<std::vector<std::uint8_t>> deep(100, {0, 1});
  deep.push_back({1, 2, 0, 1});
  EXPECT_THAT([&] { WordIndex::parse(binary(deep)); },
              ThrowsMessage<base::Error>(HasSubstr("its tree is too deep")));
}

TEST(WordIndexBytes, HoldFiniteWords) {
  const auto leaf = [](float word) {
    std::vector<std::uint8_t> bytes{1, 2, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0};
    std::memcpy(bytes.data() + 8, &word, sizeof word);
    return withTree(DescriptorKind::kFloat, 1, bytes);
  };
  EXPECT_TRUE(tryParse(leaf(0.5f)));
  EXPECT_THAT([&] { WordIndex::parse(leaf(std::nanf(""))); },
              ThrowsMessage<base::Error>(HasSubstr("its descriptors are not finite")));
}

TEST(WordIndexBytes, TellWhatIsWrong) {
  auto bytes = sample();
  bytes[7] = 2;
  seal(bytes);
  EXPECT_THAT([&] { WordIndex::parse(bytes); }, ThrowsMessage<base::Error>(HasSubstr("newer version")));
  bytes[0] = 'X';
  seal(bytes);
  EXPECT_THAT([&] { WordIndex::parse(bytes); }, ThrowsMessage<base::Error>(HasSubstr("something else")));
  bytes[20] ^= 1;
  EXPECT_THAT([&] { WordIndex::parse(bytes); }, ThrowsMessage<base::Error>(HasSubstr("checksum")));
}

}  // namespace
}  // namespace engram::vocabulary

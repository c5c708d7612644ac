// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/inverted_index.h"

#include "engram/base/rng.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

namespace engram::vocabulary {
namespace {

using base::PlaceId;
using base::ViewId;
using base::WordId;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<WordId> words(const std::vector<std::uint32_t>& numbers) {
  std::vector<WordId> ids;
  for (const auto n : numbers) ids.emplace_back(n);
  return ids;
}

/// The definition of A-17 over a list of views.
struct Oracle {
  struct View {
    std::uint32_t place;
    std::vector<std::uint32_t> words;
  };
  std::map<std::uint32_t, View> views;

  std::set<std::uint32_t> allWords() const {
    std::set<std::uint32_t> all;
    for (const auto& [id, view] : views) all.insert(view.words.begin(), view.words.end());
    return all;
  }
  std::map<std::uint32_t, double> vote(const std::vector<std::uint32_t>& query) const {
    std::map<std::uint32_t, std::vector<std::uint32_t>> places;
    for (const auto& [id, view] : views) {
      auto& all = places[view.place];
      all.insert(all.end(), view.words.begin(), view.words.end());
    }
    std::map<std::uint32_t, double> votes;
    for (const auto w : std::set<std::uint32_t>(query.begin(), query.end())) {
      double having = 0;
      for (const auto& [p, all] : places) having += std::count(all.begin(), all.end(), w) > 0;
      for (const auto& [p, all] : places) {
        const auto n = static_cast<double>(std::count(all.begin(), all.end(), w));
        if (n > 0 && having < static_cast<double>(places.size()))
          votes[p] +=
              n / static_cast<double>(all.size()) * std::log(static_cast<double>(places.size()) / having);
      }
    }
    return votes;
  }
};

TEST(InvertedIndex, VotesByTheTableOfTfIdf) {
  InvertedIndex index;
  index.add(PlaceId(3), ViewId(0), words({1, 1, 2, 9}));
  index.add(PlaceId(5), ViewId(1), words({2, 9}));
  index.add(PlaceId(7), ViewId(2), words({9}));
  index.add(PlaceId(3), ViewId(3), words({2, 4}));
  const double ln3 = std::log(3.0), ln32 = std::log(1.5);
  // Word 9 is everywhere and says nothing; word 1 counts once in the query, twice in the place.
  const auto votes = index.vote(words({1, 1, 1, 2, 9, 77}));
  ASSERT_EQ(votes.size(), 2u);
  EXPECT_EQ(votes[0].place, PlaceId(3));
  EXPECT_DOUBLE_EQ(votes[0].score, 2.0 / 6 * ln3 + 2.0 / 6 * ln32);
  EXPECT_EQ(votes[1].place, PlaceId(5));
  EXPECT_DOUBLE_EQ(votes[1].score, 1.0 / 2 * ln32);
  EXPECT_DOUBLE_EQ(index.maxVote(), ln3);
}

TEST(InvertedIndex, GivesThePlaceWithAllWordsTheLargestVoteThereIs) {
  InvertedIndex index;
  index.add(PlaceId(0), ViewId(0), words({1, 2, 3, 3}));
  index.add(PlaceId(1), ViewId(1), words({4}));
  const auto votes = index.vote(words({1, 2, 3, 8, 9}));
  ASSERT_EQ(votes.size(), 1u);
  EXPECT_DOUBLE_EQ(votes[0].score, index.maxVote());
}

TEST(InvertedIndex, HasNoVotesWhereThereIsNothing) {
  InvertedIndex index;
  EXPECT_THAT(index.vote(words({1})), IsEmpty());
  EXPECT_EQ(index.maxVote(), 0.0);
  index.add(PlaceId(0), ViewId(0), words({1}));
  EXPECT_THAT(index.vote(words({1})), IsEmpty()) << "one place alone: log(1 / 1)";
  index.add(PlaceId(1), ViewId(1), {});
  EXPECT_EQ(index.vote(words({1})).size(), 1u) << "a place without words counts";
  EXPECT_THAT(index.vote({}), IsEmpty());
}

TEST(InvertedIndex, AgreesWithBruteForceThroughAdditionsAndRemovals) {
  base::Rng rng(1);
  InvertedIndex index;
  Oracle oracle;
  for (std::uint32_t k = 0; k < 400; ++k) {
    const auto before = oracle.allWords();
    std::vector<WordId> gone;
    const double choice = rng.uniform();
    if (choice < 0.6) {
      Oracle::View view{rng.below(25), {}};
      for (std::uint32_t i = rng.below(20); i > 0; --i) view.words.push_back(rng.below(120));
      index.add(PlaceId(view.place), ViewId(k), words(view.words));
      oracle.views[k] = view;
    } else if (choice < 0.9) {
      const std::uint32_t view = rng.below(k + 1);
      gone = index.removeView(ViewId(view));
      oracle.views.erase(view);
    } else {
      const std::uint32_t place = rng.below(25);
      gone = index.removePlace(PlaceId(place));
      std::erase_if(oracle.views, [&](const auto& v) { return v.second.place == place; });
    }
    const auto after = oracle.allWords();
    std::vector<std::uint32_t> expected;
    if (choice >= 0.6)
      std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                          std::back_inserter(expected));
    ASSERT_EQ(gone, words(expected));
    ASSERT_EQ(index.words(), after.size());
    std::vector<std::uint32_t> query;
    for (int i = 0; i < 15; ++i) query.push_back(rng.below(130));
    const auto truth = oracle.vote(query);
    const auto votes = index.vote(words(query));
    ASSERT_EQ(votes.size(), truth.size());
    std::size_t i = 0;
    for (const auto& [place, score] : truth) {
      ASSERT_EQ(votes[i].place, PlaceId(place));
      ASSERT_NEAR(votes[i++].score, score, 1e-12);
    }
  }
  EXPECT_GT(index.views().size(), 20u) << "the sequence has tested something";
}

TEST(InvertedIndex, DoesNotRememberHowItCameAbout) {
  base::Rng rng(2);
  InvertedIndex direct, detour;
  std::vector<std::vector<WordId>> views;
  for (int v = 0; v < 30; ++v) {
    views.emplace_back();
    for (int i = 0; i < 12; ++i) views.back().emplace_back(rng.below(50));
  }
  const auto add = [&](InvertedIndex& index, std::uint32_t v) {
    index.add(PlaceId(v / 2), ViewId(v), views[v]);
  };
  for (std::uint32_t v = 0; v < 20; ++v) add(direct, v);
  for (std::uint32_t v = 30; v-- > 0;) add(detour, v);
  for (std::uint32_t p = 10; p < 15; ++p) detour.removePlace(PlaceId(p));
  detour.removeView(ViewId(4));
  detour.removePlace(PlaceId(8));
  add(detour, 17);
  add(detour, 4);
  add(detour, 16);
  EXPECT_EQ(detour, direct);
  for (const auto& query : views) EXPECT_EQ(detour.vote(query), direct.vote(query));
}

TEST(InvertedIndex, RefusesWhatWouldBreakIt) {
  InvertedIndex index;
  index.add(PlaceId(0), ViewId(0), words({1}));
  EXPECT_THROW(index.add(PlaceId(1), ViewId(0), words({2})), std::invalid_argument);
  EXPECT_THROW(index.add(PlaceId(), ViewId(1), words({2})), std::invalid_argument);
  EXPECT_THROW(index.add(PlaceId(1), ViewId(), words({2})), std::invalid_argument);
  const std::vector<WordId> invalid{WordId(1), WordId()};
  EXPECT_THROW(index.add(PlaceId(1), ViewId(1), invalid), std::invalid_argument);
  EXPECT_EQ(index.places(), 1u);
  EXPECT_THAT(index.removeView(ViewId(9)), IsEmpty());
  EXPECT_THAT(index.removePlace(PlaceId(9)), IsEmpty());
  EXPECT_THAT(index.removePlace(PlaceId(0)), ElementsAre(WordId(1)));
}

}  // namespace
}  // namespace engram::vocabulary

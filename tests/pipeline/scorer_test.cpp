// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/scorer.h"

#include "engram/memory/models.h"
#include "engram/pipeline/perception.h"
#include "engram/pipeline/pipeline.h"
#include "engram/pipeline/place_match.h"
#include "engram/vocabulary/word_index.h"
#include "tiny_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace engram::pipeline {
namespace {

using engram::testing::firstDrive;
using engram::testing::secondDrive;
using engram::testing::tinyParams;

types::Features featuresOf(const types::Frame& frame) {
  static Perception perception(tinyParams().camera, {});
  EXPECT_TRUE(perception.refusal(frame.image).empty());
  return perception(frame.image);
}

PipelineParams wordParams(int rescore) {
  PipelineParams params = tinyParams();
  params.recognise.scorer = "tfidf_incremental";
  params.recognise.rescore = rescore;
  return params;
}

/// Every second frame of the first drive is a place.
const std::vector<map::Place>& places() {
  static const std::vector<map::Place> made = [] {
    std::vector<map::Place> list;
    for (std::size_t i = 0; i < firstDrive().frames.size(); i += 2) {
      map::Place place;
      place.id = base::PlaceId(static_cast<std::uint32_t>(list.size()));
      place.memory = memory::makeMemoryModel({}, {}, {})->start(featuresOf(firstDrive().frames[i]));
      list.push_back(std::move(place));
    }
    return list;
  }();
  return made;
}

std::unique_ptr<Scorer> loaded(const PipelineParams& params) {
  auto scorer = makeScorer(params);
  for (std::size_t i = 0; i < places().size(); ++i) scorer->placeChanged(i, places()[i]);
  return scorer;
}

types::Features longTerm(const map::Place& place) {
  return place.memory->features.subset(place.memory->longTerm());
}

std::size_t indexOfLargest(const std::vector<double>& v) {
  return static_cast<std::size_t>(std::max_element(v.begin(), v.end()) - v.begin());
}

/// F eq (8), but a place that remembers little counts as one of mean size.
TEST(LtmMatchScorer, IsEquation8OfEachPlace) {
  int mean = 0;
  for (const auto& place : places()) mean += static_cast<int>(longTerm(place).size());
  mean /= static_cast<int>(places().size());
  const auto scorer = loaded(tinyParams());
  const types::Features view = featuresOf(secondDrive().frames[7]);
  const auto scores = scorer->scores(view);
  ASSERT_EQ(scores.size(), places().size());
  for (std::size_t i = 0; i < scores.size(); i += 3) {
    const types::Features reference = longTerm(places()[i]);
    const auto matches = features::match(view, reference, tinyParams().match);
    const int size = std::max(mean, static_cast<int>(reference.size()));
    EXPECT_DOUBLE_EQ(scores[i], similarity(static_cast<int>(matches.size()), size));
  }
}

TEST(WordScorer, VotesAreThoseOfTheWordIndex) {
  const auto scorer = loaded(wordParams(0));
  vocabulary::WordIndex words{vocabulary::WordParams()};
  for (const auto& place : places()) {
    const types::Features reference = longTerm(place);
    words.learn(place.id, base::ViewId(place.id.value), reference.descriptors,
                words.recognise(reference.descriptors).matches);
  }
  const types::Features view = featuresOf(secondDrive().frames[4]);
  std::vector<double> expected(places().size(), 0.0);
  for (const auto& vote : words.recognise(view.descriptors).votes)
    expected[vote.place.value] = vote.score / words.index().maxVote();
  EXPECT_EQ(scorer->scores(view), expected);
}

TEST(WordScorer, RescoredPlacesScoreAsByMatchesAndTheRestAsTheLeastOfThem) {
  const types::Features view = featuresOf(secondDrive().frames[10]);
  const auto matched = loaded(tinyParams())->scores(view);
  const auto votes = loaded(wordParams(0))->scores(view);
  EXPECT_EQ(loaded(wordParams(1000))->scores(view), matched);

  const auto some = loaded(wordParams(5))->scores(view);
  std::vector<std::size_t> order(votes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return votes[a] > votes[b]; });
  double least = 1;
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(some[order[k]], matched[order[k]]);
    least = std::min(least, matched[order[k]]);
  }
  for (std::size_t k = 5; k < order.size(); ++k) EXPECT_EQ(some[order[k]], least);
}

TEST(WordScorer, FindsThePlaceOfALaterDay) {
  const auto scorer = loaded(wordParams(0));
  int right = 0, asked = 0;
  for (std::size_t i = 0; i < secondDrive().frames.size(); i += 4, ++asked) {
    const auto at = secondDrive().T_world_robot[i].translation();
    const std::size_t found = indexOfLargest(scorer->scores(featuresOf(secondDrive().frames[i])));
    right += (firstDrive().T_world_robot[2 * found].translation() - at).norm() < 1.5;
  }
  EXPECT_GE(right, asked * 8 / 10) << "of " << asked;
}

// A place that learns is indexed anew: words that it lost vote for it no more.
TEST(WordScorer, FollowsWhatAPlaceRemembers) {
  const auto scorer = loaded(wordParams(0));
  const types::Features first = longTerm(places()[0]);
  ASSERT_EQ(indexOfLargest(scorer->scores(first)), 0u);
  map::Place changed = places()[8];
  changed.id = places()[0].id;
  scorer->placeChanged(0, changed);
  const auto scores = scorer->scores(first);
  EXPECT_NE(indexOfLargest(scores), 0u);
  EXPECT_LT(scores[0], 0.2 * loaded(wordParams(0))->scores(first)[0]);
  // And back: the votes are as they were, though the words have other numbers.
  scorer->placeChanged(0, places()[0]);
  EXPECT_EQ(indexOfLargest(scorer->scores(first)), 0u);
}

TEST(WordScorer, DoesNotDependOnThreads) {
  auto two = wordParams(6);
  two.recognise.threads = 2;
  const types::Features view = featuresOf(secondDrive().frames[20]);
  EXPECT_EQ(loaded(two)->scores(view), loaded(wordParams(6))->scores(view));
}

TEST(WordScorer, MapperMapsWithIt) {
  Pipeline mapper(wordParams(30)), reference(tinyParams());
  int recognised = 0, byMatches = 0, wrong = 0;
  const auto& truth = firstDrive().T_world_robot;
  for (const auto& frame : firstDrive().frames) {
    const types::FrameReport report = mapper.process(frame);
    byMatches += reference.process(frame).outcome == types::Outcome::kRecognised;
    if (report.outcome != types::Outcome::kRecognised) continue;
    ++recognised;
    const auto made = static_cast<std::size_t>(mapper.map().place(report.place).createdIndex);
    const auto here = static_cast<std::size_t>(frame.index);
    wrong += (truth[made].translation() - truth[here].translation()).norm() > 2;
  }
  mapper.map().checkInvariants();
  EXPECT_GE(recognised, byMatches - 2);
  EXPECT_NEAR(static_cast<double>(mapper.map().places().size()),
              static_cast<double>(reference.map().places().size()), 2);
  EXPECT_EQ(wrong, 0);
}

/// D-03: the order of the places is that of the numbers of matches, whatever they remember.
TEST(MatchedPoints, CountMatchesAndNothingElse) {
  PipelineParams params = tinyParams();
  params.recognise.scorer = "matched_points";
  const auto scorer = loaded(params);
  for (const std::size_t frame : {3u, 11u}) {
    const types::Features view = featuresOf(secondDrive().frames[frame]);
    const auto scores = scorer->scores(view);
    ASSERT_EQ(scores.size(), places().size());
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const auto matches = features::match(view, longTerm(places()[i]), params.match).size();
      EXPECT_DOUBLE_EQ(scores[i] * scores[i] * static_cast<double>(view.size()),
                       static_cast<double>(matches));
    }
  }
}

}  // namespace
}  // namespace engram::pipeline

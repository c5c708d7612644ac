// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One test for every law of the Feature Stability Histogram.
#include "engram/memory/fsh.h"
#include "make_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

namespace engram::memory {
namespace {

using testing::Each;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

std::vector<types::Match> matchesWithDistances(const std::vector<float>& distances) {
  std::vector<types::Match> matches;
  for (std::size_t i = 0; i < distances.size(); ++i)
    matches.push_back({static_cast<int>(i), static_cast<int>(i), distances[i]});
  return matches;
}

types::MemoryChange see(const Fsh& model, PlaceMemory& memory, const types::Features& view,
                        float distance = 0.2f) {
  return model.update(memory, view, trueMatches(view, memory, distance));
}

// The figures of F-E7: distances 0.2 +- 0.06 give a median vote of 3.5e-5 with the literal variance and 0.40
// with the second moment.
TEST(RehearsalVote, ReproducesTheFiguresForBothVariances) {
  base::Rng rng(1);
  std::vector<float> distances(4001);
  for (auto& d : distances) d = static_cast<float>(std::abs(rng.normal(0.2, 0.06)));
  const auto matches = matchesWithDistances(distances);
  FshParams params;
  const double sensible = median(rehearsalVotes(matches, params));
  EXPECT_NEAR(sensible, std::exp(-0.04 / (0.04 + 0.0036)), 0.01);
  EXPECT_NEAR(sensible, 0.40, 0.01);
  params.vote_variance = "literal";
  const double literal = median(rehearsalVotes(matches, params));
  EXPECT_GT(literal, 0.5e-5);
  EXPECT_LT(literal, 5e-5);
}

TEST(RehearsalVote, FallsWithTheDistanceAndNeverExceedsTheNominalVote) {
  FshParams params;
  params.vote = 3;
  for (const char* variance : {"second_moment", "literal", "fixed"}) {
    params.vote_variance = variance;
    const auto votes = rehearsalVotes(matchesWithDistances({0.f, 0.1f, 0.2f, 0.4f}), params);
    EXPECT_DOUBLE_EQ(votes[0], 3.0);
    EXPECT_TRUE(std::is_sorted(votes.rbegin(), votes.rend())) << variance;
    EXPECT_GT(votes[3], 0);
  }
}

TEST(RehearsalVote, FixedSigmaIsTheClosedForm) {
  FshParams params;
  params.vote_variance = "fixed";
  params.fixed_sigma = 0.5;
  EXPECT_NEAR(rehearsalVotes(matchesWithDistances({0.25f}), params)[0], std::exp(-0.25), 1e-12);
}

TEST(RehearsalVote, IsFiniteForOneMatchEqualMatchesAndPerfectMatches) {
  FshParams params;
  for (const char* variance : {"second_moment", "literal"}) {
    params.vote_variance = variance;
    EXPECT_NEAR(rehearsalVotes(matchesWithDistances({0.3f}), params)[0], std::exp(-1.0), 1e-9);
    EXPECT_THAT(rehearsalVotes(matchesWithDistances({0.3f, 0.3f, 0.3f}), params),
                Each(testing::DoubleNear(std::exp(-1.0), 1e-9)));
    EXPECT_THAT(rehearsalVotes(matchesWithDistances({0.f, 0.f}), params), Each(1.0));
    EXPECT_TRUE(rehearsalVotes({}, params).empty());
  }
}

// F-E8: 600 responses with a heavy tail have a median new vote near 0.007 with the L2 norm.
TEST(InsertionVote, ReproducesTheFigureForTheL2Norm) {
  base::Rng rng(2);
  std::vector<types::Keypoint> keypoints(600);
  for (auto& keypoint : keypoints) keypoint.response = static_cast<float>(std::exp(1.7 * rng.normal()));
  FshParams params;
  params.new_vote = "l2";
  const auto l2 = insertionVotes(keypoints, params);
  EXPECT_NEAR(median(l2), 0.007, 0.004);
  EXPECT_NEAR(std::inner_product(l2.begin(), l2.end(), l2.begin(), 0.0), 1.0, 1e-9);
  params.new_vote = "max";
  const auto byMax = insertionVotes(keypoints, params);
  EXPECT_DOUBLE_EQ(*std::max_element(byMax.begin(), byMax.end()), 1.0);
  EXPECT_GT(median(byMax), median(l2));
}

/// By rank every tail gives the same votes, and a threshold of 0.7 takes three tenths of a first view.
TEST(InsertionVote, ByRankDoesNotDependOnTheTail) {
  FshParams params;
  params.new_vote = "rank";
  std::vector<types::Keypoint> keypoints(5);
  const std::vector<float> responses{-9, 0.5f, 0.5f, 1e6f, 2};
  for (std::size_t i = 0; i < 5; ++i) keypoints[i].response = responses[i];
  EXPECT_THAT(insertionVotes(keypoints, params), testing::ElementsAre(0.8, 0.4, 0.4, 1.0, 0.6));
  params.vote = 2;
  EXPECT_THAT(insertionVotes(keypoints, params), testing::ElementsAre(1.6, 0.8, 0.8, 2.0, 1.2));
  params = bareParams();
  params.new_vote = "rank";
  std::vector<int> identities(100);
  std::iota(identities.begin(), identities.end(), 0);
  std::vector<float> tail;
  for (const int i : identities) tail.push_back(std::exp(0.2f * static_cast<float>(i)));
  EXPECT_EQ(Fsh(params).start(makeFeatures(identities, tail)).longTerm().size(), 31u);
}

TEST(InsertionVote, UsesTheMagnitudeAndSurvivesADetectorWithoutResponses) {
  std::vector<types::Keypoint> keypoints(2);
  keypoints[0].response = -4;
  keypoints[1].response = 1;
  EXPECT_THAT(insertionVotes(keypoints, {}), testing::ElementsAre(1.0, 0.25));
  keypoints[0].response = keypoints[1].response = 0;
  EXPECT_THAT(insertionVotes(keypoints, {}), Each(1.0));
}

TEST(FshStart, ClassifiesByStrengthAndStoresQuantised) {
  const Fsh model(bareParams());
  const auto view = makeFeatures({1, 2, 3}, {10, 7.1f, 6.9f});
  const auto memory = model.start(view);
  EXPECT_EQ(memory.longTerm(), (std::vector<int>{0, 1}));
  EXPECT_EQ(memory.updates, 1u);
  EXPECT_EQ(memory.features.descriptors, types::quantised(view.descriptors));
  EXPECT_THAT(memory.states[2].history, testing::ElementsAre(176));  // 0.69 * 255
}

// F-E10: one dominant response would leave a single long-term feature.
TEST(FshStart, KeepsAFloorOfLongTermFeatures) {
  auto params = bareParams();
  params.ltm_min_features = 3;
  const auto memory = Fsh(params).start(makeFeatures({1, 2, 3, 4, 5}, {100, 1, 4, 3, 2}));
  EXPECT_EQ(memory.longTerm(), (std::vector<int>{0, 2, 3}));
  params.ltm_min_features = 50;
  EXPECT_EQ(Fsh(params).start(makeFeatures({1, 2, 3}, {100, 1, 4})).longTerm().size(), 3u);
}

TEST(FshUpdate, FollowsTheClosedFormOfAccumulatedVotes) {
  auto params = bareParams();
  params.vote_variance = "fixed";
  params.fixed_sigma = 0.4;
  const Fsh model(params);
  const auto view = makeFeatures({1, 2}, {10, 5});
  auto memory = model.start(view);
  const double vote = std::exp(-(0.2 * 0.2) / (0.4 * 0.4));
  for (int n = 1; n <= 30; ++n) {
    see(model, memory, view);
    EXPECT_NEAR(find(memory, 1)->value, 1.0 + n * vote, 1e-4);
    EXPECT_NEAR(find(memory, 2)->value, 0.5 + n * vote, 1e-4);
    EXPECT_EQ(find(memory, 2)->age, n);
  }
}

TEST(FshUpdate, DecayBoundsTheHistogramByTheGeometricSeries) {
  auto params = bareParams();
  params.vote_variance = "fixed";
  params.fixed_sigma = 0.4;
  params.decay = 0.9;
  const Fsh model(params);
  const auto view = makeFeatures({1}, {10});
  auto memory = model.start(view);
  for (int n = 0; n < 300; ++n) see(model, memory, view);
  EXPECT_NEAR(memory.states[0].value, std::exp(-0.25) / (1 - 0.9), 1e-3);
}

// F-E3: read literally, Algorithm 1 would rehearse long-term features only.
TEST(FshUpdate, PromotesARehearsedShortTermFeature) {
  const Fsh model(bareParams());
  auto memory = model.start(makeFeatures({1, 2}, {10, 5}));
  ASSERT_EQ(find(memory, 2)->stage, Stage::kShortTerm);
  const auto view = makeFeatures({2}, {5});
  const auto change = see(model, memory, view, 0.0f);
  EXPECT_EQ(find(memory, 2)->stage, Stage::kLongTerm);   // 1.5 against 1
  EXPECT_EQ(find(memory, 1)->stage, Stage::kShortTerm);  // 1 / 1.5 < 0.7
  EXPECT_EQ(change.rehearsed, 1);
  EXPECT_EQ(change.promoted, 1);
  EXPECT_EQ(change.demoted, 1);
}

// F-03: occlusion lowers the relative weight; the raw votes stay, and re-observation restores the weight.
TEST(FshUpdate, OcclusionLowersTheRelativeWeightAndReobservationRestoresIt) {
  const Fsh model(bareParams());
  const auto all = makeFeatures({1, 2}, {10, 9});
  const auto occluded = makeFeatures({1}, {10});
  auto memory = model.start(all);
  const auto relative = [&] { return find(memory, 2)->value / find(memory, 1)->value; };
  for (int n = 0; n < 4; ++n) see(model, memory, all);
  const float before = relative(), raw = find(memory, 2)->value;
  float last = before;
  for (int n = 0; n < 6; ++n) {
    see(model, memory, occluded);
    EXPECT_LT(relative(), last);
    last = relative();
  }
  EXPECT_EQ(find(memory, 2)->value, raw);
  EXPECT_EQ(find(memory, 2)->stage, Stage::kShortTerm);
  for (int n = 0; n < 12; ++n) {
    see(model, memory, all);
    EXPECT_GT(relative(), last);
    last = relative();
  }
  EXPECT_EQ(find(memory, 2)->stage, Stage::kLongTerm);
}

// F-01: a strong input bypasses short-term memory.
TEST(FshUpdate, AStrongNewFeatureEntersLongTermMemoryAtOnce) {
  const Fsh model(bareParams());
  auto memory = model.start(makeFeatures({1, 2}, {10, 8}));
  const auto change = see(model, memory, makeFeatures({7, 8}, {30, 6}));
  EXPECT_EQ(find(memory, 7)->stage, Stage::kLongTerm);
  EXPECT_EQ(find(memory, 8)->stage, Stage::kShortTerm);
  EXPECT_EQ(change.added, 2);
  EXPECT_EQ(change.promoted, 1);
}

// F-E4.
TEST(FshUpdate, DoesNotInsertANearDuplicate) {
  auto params = bareParams();
  const auto known = makeFeatures({1, 2}, {10, 9});
  const auto again = makeFeatures({2, 3}, {10, 9});  // 2 fails its match, 3 is new
  Fsh model(params);
  auto memory = model.start(known);
  EXPECT_EQ(model.update(memory, again, {}).added, 1);
  EXPECT_EQ(memory.features.size(), 3u);

  params.duplicate_distance = 0;
  memory = model.start(known);
  EXPECT_EQ(Fsh(params).update(memory, again, {}).added, 2);
}

TEST(FshUpdate, FindsNearDuplicatesOfBinaryDescriptorsToo) {
  types::Features view;
  view.descriptors = types::Descriptors(types::DescriptorKind::kBinary, 128);
  view.descriptors.resize(2);
  view.keypoints.resize(2);
  std::fill_n(view.descriptors.mutableRow(1), 8, std::byte{0xFF});
  const Fsh model(bareParams());
  auto memory = model.start(view);
  types::Features other = view.subset(std::vector<int>{0, 1});
  *other.descriptors.mutableRow(0) = std::byte{0x0F};             // 4 of 128 bits: the same patch
  std::fill_n(other.descriptors.mutableRow(1), 4, std::byte{0});  // 32 bits away from both
  EXPECT_EQ(model.update(memory, other, {}).added, 1);
}

// F-E5: the age of the feature counts, not the number of updates of the place.
TEST(FshPrune, GivesEveryFeatureItsOwnChances) {
  auto params = bareParams();
  params.prune_view = 4;
  const Fsh model(params);
  const auto stable = makeFeatures({1}, {10});
  auto memory = model.start(stable);
  for (int n = 0; n < 6; ++n) see(model, memory, stable, 0.0f);
  see(model, memory, makeFeatures({1, 50}, {10, 0.1f}), 0.0f);
  for (int n = 1; n <= 3; ++n) {
    EXPECT_EQ(see(model, memory, stable, 0.0f).pruned, 0);
    ASSERT_NE(find(memory, 50), nullptr) << n;
  }
  EXPECT_EQ(see(model, memory, stable, 0.0f).pruned, 1);
  EXPECT_EQ(find(memory, 50), nullptr);
}

TEST(FshPrune, FollowsEquationFour) {
  // All are seen n times with vote 1 but the last three, never again: values 1 + n against their first votes.
  auto params = bareParams();
  const Fsh model(params);
  auto memory = model.start(makeFeatures({1, 2, 3, 4}, {1, 0.26f, 0.24f, 0.19f}));
  const auto stable = makeFeatures({1}, {1});
  for (int n = 1; n <= 3; ++n) see(model, memory, stable, 0.0f);
  EXPECT_EQ(memory.features.size(), 4u);
  see(model, memory, stable, 0.0f);  // max = 5, bound 0.2
  EXPECT_NE(find(memory, 2), nullptr);
  EXPECT_NE(find(memory, 3), nullptr);
  EXPECT_EQ(find(memory, 4), nullptr);
}

TEST(FshPrune, RehearsalSavesAFeature) {
  const Fsh model(bareParams());
  auto memory = model.start(makeFeatures({1, 2}, {1, 0.1f}));
  see(model, memory, makeFeatures({1, 2}, {1, 0.1f}), 0.0f);
  for (int n = 0; n < 20; ++n) see(model, memory, makeFeatures({1}, {1}), 0.0f);
  EXPECT_NE(find(memory, 2), nullptr);
}

// F-E6: with votes far below one, 1/max exceeds every value.
TEST(FshPrune, NeverEmptiesAPlaceNorTakesLongTermFeatures) {
  for (const char* norm : {"l2", "max"}) {
    auto params = bareParams();
    params.new_vote = norm;
    params.vote_variance = "literal";
    params.ltm_min_features = 5;
    params.prune_view = 1;
    const Fsh model(params);
    base::Rng rng(3);
    PlaceMemory memory;
    for (int n = 0; n < 200; ++n) {
      std::vector<int> ids(20);
      std::vector<float> responses(20);
      for (std::size_t i = 0; i < 20; ++i) {
        ids[i] = static_cast<int>(20 * n + static_cast<int>(i));
        responses[i] = static_cast<float>(rng.uniform(0.1, 1));
      }
      const auto view = makeFeatures(ids, responses);
      if (n == 0) {
        memory = model.start(view);
        continue;
      }
      std::set<std::uint32_t> longTerm;
      for (const int i : memory.longTerm()) longTerm.insert(memory.states[static_cast<std::size_t>(i)].id);
      see(model, memory, rng.uniform() < 0.3 ? types::Features{} : view);
      ASSERT_GE(memory.longTerm().size(), 5u);
      for (const auto& state : memory.states) longTerm.erase(state.id);
      ASSERT_TRUE(longTerm.empty()) << "a long-term feature was pruned";
    }
  }
}

TEST(FshPrune, DoesNotDependOnTheUnitOfTheVote) {
  const auto run = [](double vote) {
    auto params = bareParams();
    params.vote = vote;
    const Fsh model(params);
    base::Rng rng(4);
    auto memory = model.start(makeFeatures({0, 1, 2, 3}, {1, 0.8f, 0.5f, 0.1f}));
    for (int n = 1; n < 30; ++n) {
      std::vector<int> ids{0, 100 + n};
      if (rng.uniform() < 0.4) ids.push_back(1);
      see(model, memory, makeFeatures(ids, {1, 0.05f, 0.3f}));
    }
    std::vector<std::pair<std::uint32_t, Stage>> result;
    for (const auto& s : memory.states) result.emplace_back(s.id, s.stage);
    return result;
  };
  EXPECT_EQ(run(1.0), run(8.0));
}

TEST(FshCap, DropsTheFewestVotesPerUpdate) {
  auto params = bareParams();
  params.max_features = 4;
  params.prune_view = 2;
  const Fsh model(params);
  auto memory = model.start(makeFeatures({1, 2, 3, 4}, {10, 9, 6, 5}));
  see(model, memory, makeFeatures({1, 2}, {1, 1}));
  auto change = see(model, memory, makeFeatures({1, 2, 9}, {10, 10, 2}));
  EXPECT_EQ(memory.features.size(), 4u);
  EXPECT_EQ(change.pruned, 1);
  EXPECT_EQ(find(memory, 4), nullptr);  // 0.5 votes in 3 updates, against 0.2 in one of the new feature 9
  EXPECT_NE(find(memory, 9), nullptr);
}

TEST(FshCap, DropsTheOldestOfEqualOnesAndHoldsAtTheFirstView) {
  auto params = bareParams();
  params.max_features = 3;
  const Fsh model(params);
  const auto memory = model.start(makeFeatures({1, 2, 3, 4, 5}, {9, 1, 1, 1, 8}));
  EXPECT_EQ(memory.features.size(), 3u);
  EXPECT_NE(find(memory, 1), nullptr);
  EXPECT_NE(find(memory, 4), nullptr);
  EXPECT_NE(find(memory, 5), nullptr);
}

TEST(FshIds, AreUniqueAndNeverReused) {
  auto params = bareParams();
  params.max_features = 12;
  params.prune_view = 1;
  const Fsh model(params);
  std::set<std::uint32_t> gone;
  auto memory = model.start(makeFeatures({0, 1, 2}, {3, 2, 1}));
  for (int n = 1; n < 60; ++n) {
    std::set<std::uint32_t> before, after;
    for (const auto& s : memory.states) before.insert(s.id);
    see(model, memory, makeFeatures({0, 10 * n, 10 * n + 1, 10 * n + 2}, {3, 2, 1, 0.1f}));
    for (const auto& s : memory.states) {
      EXPECT_TRUE(after.insert(s.id).second);
      EXPECT_EQ(gone.count(s.id), 0u);
    }
    std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                        std::inserter(gone, gone.end()));
  }
  EXPECT_FALSE(gone.empty());
  EXPECT_EQ(memory.updates, 60u);
}

TEST(FshHistory, KeepsTheLastValuesNewestLast) {
  auto params = bareParams();
  params.history_length = 3;
  const Fsh model(params);
  auto memory = model.start(makeFeatures({1, 2}, {10, 8}));
  const auto view = makeFeatures({1}, {10});
  for (int n = 1; n <= 5; ++n) see(model, memory, view, 0.0f);
  // 0.8 against 4, 5, 6 votes.
  EXPECT_THAT(find(memory, 2)->history, testing::ElementsAre(51, 41, 34));
  EXPECT_THAT(find(memory, 1)->history, testing::ElementsAre(255, 255, 255));
}

TEST(FshDescriptor, IsKeptOrReplacedAsToldAndTheKeypointStays) {
  for (const bool newest : {false, true}) {
    auto params = bareParams();
    params.keep_descriptor = newest ? "newest" : "old";
    const Fsh model(params);
    const auto first = makeFeatures({1, 2}, {1, 1});
    auto later = makeFeatures({3}, {1});  // matched to feature 0 although it looks different
    auto memory = model.start(first);
    const std::vector<types::Match> matches{{0, 0, 0.1f}};
    model.update(memory, later, matches);
    const auto expected = types::quantised(newest ? later.descriptors : first.descriptors);
    EXPECT_TRUE(std::ranges::equal(memory.features.descriptors.row(0), expected.row(0)));
    EXPECT_EQ(memory.features.keypoints[0].x, 1.0f);
  }
}

TEST(FshOrder, OfTheViewAndOfTheMatchesDoesNotMatter) {
  auto params = bareParams();
  params.ltm_min_features = 3;
  const Fsh model(params);
  std::vector<std::vector<std::pair<float, Stage>>> results;
  for (const bool reversed : {false, true}) {
    std::vector<int> ids{1, 2, 3, 4, 5, 6};
    std::vector<float> responses{1, 1, 1, 0.3f, 0.3f, 0.2f};
    if (reversed) {
      std::ranges::reverse(ids);
      std::ranges::reverse(responses);
    }
    auto memory = model.start(makeFeatures(ids, responses));
    for (int n = 0; n < 6; ++n) {
      std::vector<int> seen{1, 4, 5, 30 + n};
      std::vector<float> strength{1, 1, 1, 0.5f};
      if (reversed) {
        std::ranges::reverse(seen);
        std::ranges::reverse(strength);
      }
      see(model, memory, makeFeatures(seen, strength));
    }
    std::vector<std::pair<float, Stage>> byIdentity;
    for (int id = 0; id < 40; ++id)
      if (const auto* s = find(memory, id)) byIdentity.emplace_back(s->value, s->stage);
    results.push_back(byIdentity);
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(FshContract, RefusesMatchesThatAreNotOneToOneAndLeavesTheMemoryAlone) {
  const Fsh model(bareParams());
  const auto view = makeFeatures({1, 2, 3}, {3, 2, 1});
  auto memory = model.start(view);
  const auto before = memory.states;
  const std::vector<std::vector<types::Match>> wrong{{{0, 0, 0.1f}, {0, 1, 0.1f}},
                                                     {{0, 1, 0.1f}, {2, 1, 0.1f}},
                                                     {{3, 0, 0.1f}},
                                                     {{0, 3, 0.1f}},
                                                     {{-1, 0, 0.1f}},
                                                     {{0, 0, -0.1f}},
                                                     {{0, 0, NAN}}};
  for (const auto& matches : wrong) {
    EXPECT_THROW(model.update(memory, view, matches), std::invalid_argument);
    EXPECT_EQ(memory.states, before);
    EXPECT_EQ(memory.updates, 1u);
  }
}

TEST(FshContract, RefusesViewsThatDoNotFitTheMemory) {
  const Fsh model(bareParams());
  const auto view = makeFeatures({1, 2}, {3, 2});
  auto memory = model.start(view);
  types::Features binary;
  binary.descriptors = types::Descriptors(types::DescriptorKind::kBinary, 64);
  binary.descriptors.resize(1);
  binary.keypoints.resize(1);
  EXPECT_THROW(model.update(memory, binary, {}), std::invalid_argument);
  auto withBearings = view;
  withBearings.bearings.assign(2, Eigen::Vector3f::UnitZ());
  EXPECT_THROW(model.update(memory, withBearings, {}), std::invalid_argument);
  auto notANumber = view;
  notANumber.keypoints[0].response = NAN;
  EXPECT_THROW(model.update(memory, notANumber, {}), std::invalid_argument);
  EXPECT_THROW(model.start(notANumber), std::invalid_argument);
  auto ragged = view;
  ragged.keypoints.pop_back();
  EXPECT_THROW(model.start(ragged), std::invalid_argument);
}

TEST(FshContract, AnEmptyPlaceAndAnEmptyViewAreLegal) {
  const Fsh model(bareParams());
  auto memory = model.start({});
  EXPECT_TRUE(memory.longTerm().empty());
  EXPECT_EQ(model.update(memory, {}, {}).longTerm, 0);
  EXPECT_EQ(model.update(memory, makeFeatures({1}, {1}), {}).longTerm, 1);
  EXPECT_EQ(memory.updates, 3u);
}

}  // namespace
}  // namespace engram::memory

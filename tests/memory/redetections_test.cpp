// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What is learnt from re-detection, against populations whose detection probabilities are known.
#include "engram/memory/redetections.h"

#include "engram/memory/multi_store.h"
#include "make_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace engram::memory {
namespace {

/// A memory without descriptors: enough to be observed.
PlaceMemory bareMemory(const std::vector<float>& values) {
  PlaceMemory memory;
  for (const float value : values) {
    FeatureState state;
    state.id = memory.nextFeatureId++;
    state.value = value;
    memory.states.push_back(state);
  }
  return memory;
}

std::vector<types::Match> hitsOf(const std::vector<bool>& hit) {
  std::vector<types::Match> matches;
  for (std::size_t i = 0; i < hit.size(); ++i)
    if (hit[i]) matches.push_back({static_cast<int>(matches.size()), static_cast<int>(i), 0.1f});
  return matches;
}

struct Kind {
  double share, p;  ///< of the features; probability of being seen in a view
};

/// Chance that a feature of this mixture, not seen again in `age` chances, is seen in the next kHorizon.
double analyticChance(const std::vector<Kind>& mixture, int age) {
  double unseen = 0, never = 0;
  for (const auto& [share, p] : mixture) {
    unseen += share * std::pow(1 - p, age);
    never += share * std::pow(1 - p, age + Redetections::kHorizon);
  }
  return 1 - never / unseen;
}

int analyticAge(const std::vector<Kind>& mixture, double chance) {
  for (int age = 1; age < Redetections::kOldestForgetting; ++age)
    if (analyticChance(mixture, age) < chance) return age;
  return Redetections::kOldestForgetting;
}

/// Many places of such features, each watched for some views. @param leave chance that a feature is pruned
/// before a view, for no reason of its own: it is censored.
Redetections watch(const std::vector<Kind>& mixture, int places, int views, double leave,
                   std::uint64_t seed) {
  Redetections seen;
  base::Rng rng(seed);
  for (int place = 0; place < places; ++place) {
    std::vector<double> p;
    for (const auto& kind : mixture)
      for (int i = 0; i < std::lround(200 * kind.share); ++i) p.push_back(kind.p);
    auto memory = bareMemory(std::vector<float>(p.size(), 1.0f));
    for (int view = 0; view < views; ++view) {
      for (std::size_t i = p.size(); i-- > 0;)
        if (rng.uniform() < leave) {
          p.erase(p.begin() + static_cast<std::ptrdiff_t>(i));
          memory.states.erase(memory.states.begin() + static_cast<std::ptrdiff_t>(i));
        }
      std::vector<bool> hit(p.size());
      for (std::size_t i = 0; i < p.size(); ++i) hit[i] = rng.uniform() < p[i];
      observe(seen, memory, hitsOf(hit));
      for (std::size_t i = 0; i < p.size(); ++i) {
        ++memory.states[i].age;
        memory.states[i].counter += hit[i];
      }
    }
  }
  return seen;
}

TEST(Observe, CountsByValueAndByAgeUntilTheFirstRedetection) {
  Redetections seen;
  auto memory = bareMemory({4, 2, 1, 0});
  memory.states[1].counter = 1;  // seen again before: no longer at risk
  memory.states[2].age = 3;
  memory.states[3].age = 500;
  observe(seen, memory, hitsOf({true, false, true, false}));
  EXPECT_EQ(seen.views, 1u);
  EXPECT_EQ(seen.byValue[63], (Redetections::Count{1, 1}));
  EXPECT_EQ(seen.byValue[32], (Redetections::Count{1, 0}));
  EXPECT_EQ(seen.byValue[16], (Redetections::Count{1, 1}));
  EXPECT_EQ(seen.byValue[0], (Redetections::Count{1, 0}));
  EXPECT_EQ(seen.byAge[0], (Redetections::Count{1, 1}));
  EXPECT_EQ(seen.byAge[3], (Redetections::Count{1, 1}));
  for (const int age : {1, 2, 4, Redetections::kAges - 1})
    EXPECT_EQ(seen.byAge[static_cast<std::size_t>(age)], Redetections::Count{});
  EXPECT_EQ(brokenRule(seen), "");
  ++seen.byAge[5].hits;
  EXPECT_NE(brokenRule(seen), "");
}

// Brute force: F1 of every threshold, feature by feature.
TEST(LearntThreshold, MaximisesTheF1Measure) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    base::Rng rng(seed);
    Redetections seen;
    std::vector<std::pair<float, bool>> all;
    const double power = rng.uniform(0.3, 4);
    for (int view = 0; view < 3000; ++view) {  // so many that the prior weighs 1 %
      std::vector<float> values{1};
      std::vector<bool> hit{rng.uniform() < 0.9};
      for (int i = 0; i < 20; ++i) {
        values.push_back(static_cast<float>(rng.uniform()));
        hit.push_back(rng.uniform() < std::pow(values.back(), power));
      }
      observe(seen, bareMemory(values), hitsOf(hit));
      for (std::size_t i = 0; i < values.size(); ++i) all.emplace_back(values[i], hit[i]);
    }
    const auto f1 = [&](double threshold) {
      int right = 0, above = 0, hits = 0;
      for (const auto& [value, isHit] : all) {
        above += value >= threshold;
        right += value >= threshold && isHit;
        hits += isHit;
      }
      return 2.0 * right / (above + hits);
    };
    double best = 0;
    for (double t = 0; t <= 1; t += 0.005) best = std::max(best, f1(t));
    EXPECT_GT(f1(learntThreshold(seen, 0.7)), best - 0.005) << "seed " << seed;
  }
}

TEST(LearntThreshold, LiesInTheMiddleOfAGapAndIsDrawnToThePrior) {
  const auto memory = bareMemory({1, 0.8f, 0.2f, 0.1f});
  const auto matches = hitsOf({true, true, false, false});
  Redetections seen;
  EXPECT_EQ(learntThreshold(seen, 0.7), 0.7);
  double last = 0.9;  // the gap is from 0.2 to 0.8
  for (int view = 1; view <= 3000; ++view) {
    observe(seen, memory, matches);
    const double now = learntThreshold(seen, 0.9);
    ASSERT_LT(now, last);
    last = now;
    if (view == 30) {
      EXPECT_NEAR(now, 0.5 * (0.9 + 0.5), 0.02) << "as much evidence as prior";
    }
  }
  EXPECT_NEAR(last, 0.5, 0.02);
}

TEST(LearntThreshold, StaysWhereNothingIsSeenAgain) {
  Redetections seen;
  for (int view = 0; view < 500; ++view) observe(seen, bareMemory({1, 0.5f}), {});
  EXPECT_EQ(learntThreshold(seen, 0.6), 0.6);
}

// Kaplan-Meier against the mixture in closed form, with and without censoring.
TEST(LaterRedetection, AgreesWithTheClosedForm) {
  const std::vector<Kind> mixture{{0.5, 0.7}, {0.5, 0.02}};
  for (const double leave : {0.0, 0.1}) {
    const auto seen = watch(mixture, 200, 16, leave, 3);
    for (int age = 0; age <= 10; ++age) {
      const auto estimate = laterRedetection(seen, age);
      ASSERT_TRUE(estimate) << age;
      const double truth = analyticChance(mixture, age);
      const auto atRisk = static_cast<double>(seen.byAge[static_cast<std::size_t>(age + 3)].trials);
      EXPECT_NEAR(*estimate, truth, 4 * std::sqrt(truth * (1 - truth) / atRisk)) << age << ' ' << leave;
    }
  }
}

TEST(LearntForgettingAge, AgreesWithTheAnalyticAge) {
  const struct {
    std::vector<Kind> mixture;
    double chance;
    int age;
  } cases[] = {{{{0.5, 0.7}, {0.5, 0.02}}, 0.1, 4},   // the paper's own age
               {{{0.3, 0.7}, {0.7, 0.02}}, 0.1, 3},   // more clutter: sooner
               {{{0.5, 0.4}, {0.5, 0.005}}, 0.1, 5},  // features that hide: later
               {{{0.5, 0.2}, {0.5, 0.005}}, 0.1, 9},
               {{{1.0, 0.01}}, 0.1, 1},   // nothing ever comes back
               {{{1.0, 0.3}}, 0.1, 16}};  // no age tells anything: a constant hazard
  for (const auto& [mixture, chance, age] : cases) {
    ASSERT_EQ(analyticAge(mixture, chance), age) << "the case is not what it says";
    EXPECT_EQ(learntForgettingAge(watch(mixture, 1000, 20, 0.0, 5), 7, chance), age);
  }
}

TEST(LearntForgettingAge, FallsBackWhereTheEvidenceEnds) {
  const std::vector<Kind> mixture{{0.5, 0.7}, {0.5, 0.02}};
  EXPECT_EQ(learntForgettingAge({}, 6, 0.1), 6);
  EXPECT_EQ(learntForgettingAge(watch(mixture, 1, 2, 0, 1), 6, 0.1), 6) << "too few trials";
  // Six views say that ages 1 and 2 are too soon, and no more.
  EXPECT_FALSE(laterRedetection(watch(mixture, 100, 6, 0, 1), 3));
  EXPECT_EQ(learntForgettingAge(watch(mixture, 100, 6, 0, 1), 1, 0.1), 3);
  EXPECT_EQ(learntForgettingAge(watch(mixture, 100, 6, 0, 1), 6, 0.1), 6);
}

/// Places with stable and ephemeral features, learning by the FSH itself.
struct Life {
  static constexpr int kStable = 40, kEphemeral = 40;
  Redetections seen;
  std::vector<PlaceMemory> places;

  Life(const FshParams& params, int count, int updates, std::uint64_t seed) {
    const Fsh model(params);
    base::Rng rng(seed);
    for (int place = 0; place < count; ++place) places.push_back(model.start(first(rng)));
    for (int n = 0; n < updates; ++n)
      for (auto& memory : places) {
        std::vector<int> ids;
        std::vector<float> responses;
        const auto add = [&](int id, double weakest, double strongest) {
          ids.push_back(id);
          responses.push_back(static_cast<float>(rng.uniform(weakest, strongest)));
        };
        for (int id = 0; id < kStable + kEphemeral; ++id)
          if (rng.uniform() < (id < kStable ? 0.7 : 0.02)) add(id, 0.1, 1);
        // Clutter so weak that eq (4) may take it: its value is below 1/max.
        for (int i = 0; i < 10; ++i) add(1000 + static_cast<int>(rng.below(1000000)), 0.001, 0.1);
        const auto view = makeFeatures(ids, responses);
        auto matches = trueMatches(view, memory, 0.1f);
        for (auto& match : matches) match.distance = static_cast<float>(std::abs(rng.normal(0.2, 0.06)));
        model.learn(memory, view, matches, seen);
      }
  }

  static types::Features first(base::Rng& rng) {
    std::vector<int> ids(kStable + kEphemeral);
    std::vector<float> responses;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ids[i] = static_cast<int>(i);
      responses.push_back(static_cast<float>(rng.uniform(0.1, 1)));
    }
    return makeFeatures(ids, responses);
  }

  /// Share of the features at or above a normalised value, of the stable ones and of the others.
  std::pair<double, double> above(double threshold) const {
    int stable = 0, stables = 0, other = 0, others = 0;
    for (const auto& memory : places) {
      float largest = 0;
      for (const auto& state : memory.states) largest = std::max(largest, state.value);
      for (std::size_t i = 0; i < memory.states.size(); ++i) {
        const bool isAbove = memory.states[i].value >= threshold * largest;
        if (memory.features.keypoints[i].x < kStable) {
          ++stables;
          stable += isAbove;
        } else {
          ++others;
          other += isAbove;
        }
      }
    }
    return {static_cast<double>(stable) / stables, static_cast<double>(other) / std::max(1, others)};
  }
};

FshParams learning() {
  auto params = bareParams();
  params.thresholds = "learned";
  return params;
}

TEST(LearningFsh, TheThresholdSeparatesStableFromEphemeral) {
  const Life life(learning(), 20, 30, 11);
  const double threshold = paramsInForce(learning(), life.seen).ltm_threshold;
  EXPECT_LT(threshold, 0.6);
  EXPECT_GT(threshold, 0.1);
  const auto [stable, ephemeral] = life.above(threshold);
  EXPECT_GT(stable, 0.97);
  EXPECT_LT(ephemeral, 0.03);
  const auto [stableFixed, ephemeralFixed] = life.above(0.7);
  EXPECT_LT(stableFixed, stable - 0.1) << "the fixed threshold would lose many";
}

TEST(LearningFsh, TheAgeIsInForceAndTheFloorHolds) {
  auto params = learning();
  params.ltm_min_features = 55;
  params.prune_view = 12;
  const Life learnt(params, 20, 30, 13);
  const int age = paramsInForce(params, learnt.seen).prune_view;
  EXPECT_LT(age, 8);
  params.thresholds = "fixed";
  const Life fixed(params, 20, 30, 13);
  double sumLearnt = 0, sumFixed = 0;
  for (std::size_t i = 0; i < learnt.places.size(); ++i) {
    EXPECT_GE(learnt.places[i].longTerm().size(), 55u);
    sumLearnt += static_cast<double>(learnt.places[i].features.size());
    sumFixed += static_cast<double>(fixed.places[i].features.size());
  }
  EXPECT_LT(sumLearnt, 0.95 * sumFixed) << "what does not come back goes sooner";
}

TEST(LearningFsh, FixedCountsButDoesNotHeed) {
  const auto view = makeFeatures({1, 2, 3}, {10, 5, 1});
  const Fsh model(bareParams());
  auto counted = model.start(view), plain = counted;
  Redetections seen;
  for (int n = 0; n < 40; ++n) {
    const auto now = makeFeatures({1, 2, 10 + n}, {10, 5, 1});
    model.learn(counted, now, trueMatches(now, counted, 0.1f), seen);
    model.update(plain, now, trueMatches(now, plain, 0.1f));
  }
  EXPECT_EQ(counted.states, plain.states);
  EXPECT_EQ(seen.views, 40u);
  EXPECT_EQ(paramsInForce(model.params(), seen).prune_view, model.params().prune_view);
}

TEST(LearningFsh, ARefusedViewIsNotCountedAndOtherMemoriesCountNothing) {
  const auto view = makeFeatures({1, 2}, {10, 5});
  Redetections seen;
  const std::vector<types::Match> wrong{{0, 0, 0.1f}, {1, 0, 0.1f}};
  const Fsh fsh(learning());
  auto memory = fsh.start(view);
  EXPECT_THROW(fsh.learn(memory, view, wrong, seen), std::invalid_argument);
  EXPECT_EQ(seen, Redetections{});
  const MultiStore stores({});
  memory = stores.start(view);
  EXPECT_EQ(stores.learn(memory, view, trueMatches(view, memory, 0.1f), seen).rehearsed, 2);
  EXPECT_EQ(seen, Redetections{});
}

}  // namespace
}  // namespace engram::memory

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/bayes_filter.h"

#include "engram/base/error.h"
#include "worlds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace engram::belief {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::HasSubstr;

double total(const Belief& belief) {
  return std::accumulate(belief.places.begin(), belief.places.end(), belief.newPlace);
}

Likelihood at(std::size_t n, std::size_t place, double others = 0.01) {
  Likelihood l;
  l.places.assign(n, others);
  l.places[place] = 1.0;
  l.newPlace = others;
  return l;
}

/// The forward algorithm with dense matrices over all states, the new place last.
class DenseForward {
 public:
  DenseForward(const Adjacency& adjacency, const BeliefParams& params, bool hasNewPlace)
      : n_(adjacency.size()) {
    const auto hops = allHops(adjacency);
    const double leave = hasNewPlace ? params.new_place_prior : 0.0;
    transition_.assign(n_ + 1, std::vector<double>(n_ + 1, 0.0));
    for (std::size_t i = 0; i < n_; ++i) {
      std::vector<double> row(n_, 0.0);
      for (std::size_t j = 0; j < n_; ++j) {
        const double d = (hops[i][j] - params.expected_hops) / params.sigma_hops;
        if (hops[i][j] <= params.hop_radius + static_cast<int>(std::ceil(params.expected_hops)))
          row[j] = std::exp(-0.5 * d * d);
      }
      const double norm = std::accumulate(row.begin(), row.end(), 0.0);
      for (std::size_t j = 0; j < n_; ++j)
        transition_[i][j] =
            (1 - leave) * ((1 - params.teleport) * row[j] / norm + params.teleport / static_cast<double>(n_));
      transition_[i][n_] = leave;
      transition_[n_][i] = (1 - params.new_place_persistence) / static_cast<double>(n_);
    }
    transition_[n_][n_] = params.new_place_persistence;
    belief_.assign(n_ + 1, (1 - leave) / static_cast<double>(n_));
    belief_[n_] = leave;
  }

  void step(const Likelihood& l) {
    std::vector<double> next(n_ + 1, 0.0);
    for (std::size_t i = 0; i <= n_; ++i)
      for (std::size_t j = 0; j <= n_; ++j) next[j] += belief_[i] * transition_[i][j];
    for (std::size_t j = 0; j < n_; ++j) next[j] *= l.places[j];
    next[n_] *= l.newPlace;
    const double norm = std::accumulate(next.begin(), next.end(), 0.0);
    for (std::size_t j = 0; j <= n_; ++j) belief_[j] = next[j] / norm;
  }

  const std::vector<double>& belief() const { return belief_; }

 private:
  std::size_t n_;
  std::vector<std::vector<double>> transition_;
  std::vector<double> belief_;
};

TEST(BayesFilter, EqualsTheForwardAlgorithm) {
  base::Rng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    const bool hasNewPlace = trial % 2;
    BeliefParams params;
    params.advance = "none";
    params.expected_hops = trial % 3;
    params.hop_radius = 2 + trial % 4;
    params.teleport = 0.05 * (trial % 4);
    const auto graph = randomGraph(9, 3, rng);
    DenseForward oracle(graph, params, hasNewPlace);
    BayesFilter filter(params, hasNewPlace);
    filter.reset(9);
    for (int t = 0; t < 25; ++t) {
      const auto l = randomLikelihood(9, rng);
      filter.predict(graph);
      ASSERT_TRUE(filter.update(l));
      oracle.step(l);
      for (std::size_t i = 0; i < 9; ++i) ASSERT_NEAR(filter.posterior().places[i], oracle.belief()[i], 1e-9);
      ASSERT_NEAR(filter.posterior().newPlace, oracle.belief()[9], 1e-9);
    }
  }
}

// In a large map mass that is nowhere in particular stays where it is: what is believed hardly differs.
TEST(BayesFilter, IsNearTheForwardAlgorithmInALargeMap) {
  constexpr std::size_t n = 300;
  base::Rng rng(3);
  BeliefParams params;
  params.advance = "none";
  const auto graph = randomGraph(static_cast<int>(n), 60, rng);
  DenseForward oracle(graph, params, true);
  BayesFilter filter(params, true);
  filter.reset(n);
  double most = 0;
  for (std::size_t t = 0; t < 60; ++t) {
    Likelihood l = randomLikelihood(n, rng);
    for (double& p : l.places) p = 0.05 + 0.1 * p;
    if (t % 20 > 3) l.places[(t / 20 * 90 + t) % n] = 1.0;  // lost first, then seen somewhere, then elsewhere
    filter.predict(graph);
    ASSERT_TRUE(filter.update(l));
    oracle.step(l);
    double apart = std::abs(filter.posterior().newPlace - oracle.belief()[n]);
    for (std::size_t i = 0; i < n; ++i) apart += std::abs(filter.posterior().places[i] - oracle.belief()[i]);
    most = std::max(most, apart / 2);
  }
  EXPECT_LT(most, 0.01);
}

/// The same with the step in the state, for a filter that learns: a dense sum over all pairs of (place,
/// step).
class StepForward : public testing::TestWithParam<int> {};

TEST_P(StepForward, IsEqualed) {
  base::Rng rng(2);
  BeliefParams params;
  params.advance_max = 2;
  params.advance_resolution = GetParam();
  params.advance_blind = 0.2;
  params.advance_forgetting = 0.0;  // then the learnt steps are those of the last posterior
  const auto graph = randomGraph(8, 2, rng);
  const auto hops = allHops(graph);
  const int n = 8, steps = 4 * GetParam() + 1;
  BayesFilter filter(params, false);
  filter.reset(n);
  std::vector<double> size, blind;
  for (int k = 0; k < steps; ++k) {
    size.push_back(-2 + 1.0 * k / GetParam());
    blind.push_back(std::exp(-0.5 * size.back() * size.back() / 4.0));
  }
  const double norm = std::accumulate(blind.begin(), blind.end(), 0.0);
  for (double& b : blind) b /= norm;
  auto drawn = blind;
  std::vector<std::vector<double>> joint(steps);
  for (int k = 0; k < steps; ++k) joint[k].assign(n, blind[k] / n);
  const auto blindRow = [&](int i) {
    std::vector<double> row(n, 0.0);
    for (int j = 0; j < n; ++j)
      if (hops[i][j] <= params.hop_radius) row[j] = std::exp(-0.5 * hops[i][j] * hops[i][j] / 4.0);
    const double sum = std::accumulate(row.begin(), row.end(), 0.0);
    for (double& r : row) r /= sum;
    return row;
  };

  for (int t = 0; t < 12; ++t) {
    for (int k = 0; t > 0 && k < steps; ++k)
      drawn[k] = 0.9 * std::accumulate(joint[k].begin(), joint[k].end(), 0.0) + 0.1 * blind[k];
    std::vector<std::vector<double>> next(steps, std::vector<double>(n, 0.0));
    for (int k = 0; k < steps; ++k)
      for (int i = 0; i < n; ++i)
        for (int kk = 0; kk < steps; ++kk) {
          const double persistence = params.advance_persistence;
          const double p = joint[k][i] * (persistence * (k == kk) + (1 - persistence) * drawn[kk]);
          double goesBlind = params.advance_blind * p;
          for (const int whole :
               {static_cast<int>(std::floor(size[kk])), static_cast<int>(std::floor(size[kk])) + 1}) {
            const double share = 1 - std::abs(size[kk] - whole);
            const int to = graph.along(i, whole);
            (to >= 0 ? next[kk][to] : goesBlind) += (1 - params.advance_blind) * share * p;
          }
          const auto row = blindRow(i);
          for (int j = 0; j < n; ++j)
            for (int q = 0; q < steps; ++q) next[q][j] += goesBlind * row[j] * drawn[q];
        }
    const auto l = randomLikelihood(n, rng);
    double z = 0;
    for (int k = 0; k < steps; ++k)
      for (int i = 0; i < n; ++i) {
        const double p = (1 - params.teleport) * next[k][i] + params.teleport / n * drawn[k];
        z += joint[k][i] = p * l.places[i];
      }
    for (auto& layer : joint)
      for (double& p : layer) p /= z;
    filter.predict(graph);
    filter.update(l);
    for (int i = 0; i < n; ++i) {
      double p = 0;
      for (int k = 0; k < steps; ++k) p += joint[k][i];
      ASSERT_NEAR(filter.posterior().places[i], p, 1e-9) << "t " << t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Resolution, StepForward, testing::Values(1, 2, 3));

TEST(BayesFilter, SumsToOneWhateverHappens) {
  base::Rng rng(3);
  for (const char* advance : {"none", "learned"}) {
    BeliefParams params;
    params.advance = advance;
    BayesFilter filter(params, true);
    std::size_t n = 0;
    std::vector<std::pair<int, int>> edges;
    for (int t = 0; t < 300; ++t) {
      if (rng.uniform() < 0.2) {
        if (n > 0) edges.emplace_back(static_cast<int>(n) - 1, static_cast<int>(n));
        filter.grow(++n, rng.uniform());
        EXPECT_NEAR(total(filter.posterior()), 1.0, 1e-12);
      }
      MotionHint hint;
      if (rng.uniform() < 0.3) hint.hops = 4 * rng.uniform();
      filter.predict(Adjacency::fromEdges(n, edges), hint);
      ASSERT_NEAR(total(filter.posterior()), 1.0, 1e-12);
      auto l = randomLikelihood(n, rng);
      if (n > 0 && rng.uniform() < 0.3) l.places[rng.below(static_cast<std::uint32_t>(n))] = 1e200;
      filter.update(l);
      ASSERT_NEAR(total(filter.posterior()), 1.0, 1e-12);
      for (const double p : filter.posterior().places) ASSERT_TRUE(p >= 0 && p <= 1 + 1e-12);
    }
  }
}

TEST(BayesFilter, DoesNotDependOnTheNumbersOfThePlaces) {
  base::Rng rng(4);
  const auto graph = randomGraph(10, 4, rng);
  BeliefParams params;
  params.advance = "none";  // the chain is by number
  const std::vector<int> to{3, 7, 1, 9, 0, 2, 8, 6, 5, 4};
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < 10; ++i)
    for (const int j : graph.neighbours[i]) edges.emplace_back(to[i], to[j]);
  const auto permutedGraph = Adjacency::fromEdges(10, edges);
  BayesFilter a(params, true), b(params, true);
  a.reset(10);
  b.reset(10);
  for (int t = 0; t < 20; ++t) {
    const auto l = randomLikelihood(10, rng);
    auto permuted = l;
    for (int i = 0; i < 10; ++i) permuted.places[to[i]] = l.places[i];
    a.predict(graph);
    b.predict(permutedGraph);
    a.update(l);
    b.update(permuted);
  }
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(a.posterior().places[i], b.posterior().places[to[i]], 1e-12);
}

TEST(BayesFilter, StartsUniform) {
  BayesFilter frozen({}, false);
  frozen.reset(4);
  EXPECT_THAT(frozen.posterior().places, Each(0.25));
  EXPECT_EQ(frozen.posterior().newPlace, 0.0);
  BayesFilter mapping({}, true);
  EXPECT_EQ(mapping.posterior().newPlace, 1.0);
  mapping.reset(4);
  EXPECT_THAT(mapping.posterior().places, Each(DoubleNear(0.9 / 4, 1e-12)));
}

// F-E2.
TEST(BayesFilter, MovesAcrossTheSeamOfARing) {
  BeliefParams params;
  params.advance = "none";
  params.teleport = 0;
  BayesFilter filter(params, false);
  filter.reset(20);
  filter.update(at(20, 0, 0.0));
  filter.predict(ring(20));
  const auto& p = filter.posterior().places;
  EXPECT_NEAR(p[19], p[1], 1e-12);
  EXPECT_NEAR(p[18], p[2], 1e-12);
  EXPECT_NEAR(p[1] / p[0], std::exp(-0.125), 1e-9);
  EXPECT_EQ(p[10], 0.0);
}

//
TEST(BayesFilter, GivesTheNeighboursMoreThanTheCentreWhenAMoveIsExpected) {
  BeliefParams params;
  params.advance = "none";
  params.expected_hops = 1;
  params.sigma_hops = 1;
  BayesFilter filter(params, false);
  filter.reset(9);
  filter.update(at(9, 4, 0.0));
  filter.predict(chain(9));
  EXPECT_GT(filter.posterior().places[3], filter.posterior().places[4]);
  EXPECT_EQ(filter.posterior().places[3], filter.posterior().places[5]);
}

TEST(BayesFilter, UsesTheDistanceTravelled) {
  for (const char* advance : {"none", "learned"}) {
    BeliefParams params;
    params.advance = advance;
    BayesFilter filter(params, false);
    filter.reset(21);
    filter.update(at(21, 10, 0.0));
    filter.predict(chain(21), {2.0});
    const auto& p = filter.posterior().places;
    EXPECT_NEAR(p[8], p[12], 1e-12);
    EXPECT_GT(p[12], 2 * p[10]) << advance;
    filter.reset(21);
    filter.update(at(21, 10, 0.0));
    filter.predict(chain(21), {0.0});
    EXPECT_GT(p[10], 0.4) << advance;
    EXPECT_NEAR(p[9], p[11], 1e-12);
  }
}

TEST(BayesFilter, IgnoresALikelihoodThatExcludesEverything) {
  BayesFilter filter({}, true);
  filter.reset(5);
  filter.update(at(5, 2));
  const auto before = filter.posterior();
  Likelihood zero;
  zero.places.assign(5, 0.0);
  EXPECT_FALSE(filter.update(zero));
  EXPECT_EQ(filter.posterior().places, before.places);
  EXPECT_EQ(filter.posterior().newPlace, before.newPlace);
}

TEST(BayesFilter, SurvivesTinyLikelihoodsForALongTime) {
  BayesFilter filter({}, false);
  filter.reset(5);
  Likelihood tiny;
  tiny.places = {1e-300, 3e-300, 1e-300, 1e-300, 1e-300};
  for (int t = 0; t < 1000; ++t) {
    filter.predict(chain(5));
    ASSERT_TRUE(filter.update(tiny));
  }
  EXPECT_EQ(filter.best(), 1);
}

TEST(BayesFilter, RecoversAfterAKidnapping) {
  for (const char* advance : {"none", "learned"}) {
    BeliefParams params;
    params.advance = advance;
    BayesFilter filter(params, false);
    filter.reset(50);
    const auto graph = chain(50);
    for (int t = 0; t < 30; ++t) {
      filter.predict(graph);
      filter.update(at(50, 10, 0.05));
    }
    EXPECT_GT(filter.posterior().places[10], 0.7);
    int images = 0;
    for (; images < 20 && filter.best() != 40; ++images) {
      filter.predict(graph);
      filter.update(at(50, 40, 0.05));
    }
    EXPECT_LE(images, 4) << advance;
  }
}

// An image like no other says nothing of a new place: that is left to what is known of the robot's way.
TEST(BayesFilter, WithoutEvidenceANewPlaceIsAsProbableAsTheWayMakesIt) {
  BayesFilter filter({}, true);
  filter.reset(200);
  const auto graph = chain(200);
  base::Rng rng(3);
  for (int t = 0; t < 60; ++t) {
    std::vector<double> s(200);
    for (double& x : s) x = std::clamp(0.1 + 0.001 * rng.normal(), 0.0, 1.0);
    filter.predict(graph);
    filter.update(likelihood(s, graph, filter.params()));
  }
  const BeliefParams& p = filter.params();
  EXPECT_NEAR(filter.posterior().newPlace,
              p.new_place_prior / (p.new_place_prior + 1 - p.new_place_persistence), 0.2);
}

TEST(BayesFilter, DecidesForANewPlaceAndBackByTheSensorOfThePaper) {
  BeliefParams paper;
  paper.likelihood = "gaussian";
  paper.new_place_similarity = 0.25;
  BayesFilter filter(paper, true);
  filter.reset(30);
  const auto graph = chain(30);
  const auto see = [&](double best, std::size_t place) {
    std::vector<double> s(30, 0.05);
    s[place] = best;
    filter.predict(graph);
    filter.update(likelihood(s, graph, filter.params()));
  };
  for (int t = 0; t < 4; ++t) see(0.7, 5);
  EXPECT_LT(filter.posterior().newPlace, 0.05);
  EXPECT_EQ(filter.best(), 5);
  for (int t = 0; t < 3; ++t) see(0.1, 20);
  EXPECT_GT(filter.posterior().newPlace, 0.8);
  for (int t = 0; t < 3; ++t) see(0.7, 12);
  EXPECT_LT(filter.posterior().newPlace, 0.1);
  EXPECT_EQ(filter.best(), 12);
}

TEST(BayesFilter, GrowingTakesTheNewPlaceFirstAndThenTheRestInProportion) {
  BayesFilter filter({}, true);
  filter.reset(3);
  filter.update(at(3, 1));
  const auto before = filter.posterior();
  filter.grow(4, before.newPlace);
  EXPECT_NEAR(filter.posterior().places[3], before.newPlace, 1e-12);
  EXPECT_NEAR(filter.posterior().newPlace, 0.0, 1e-12);
  EXPECT_NEAR(filter.posterior().places[1], before.places[1], 1e-12);
  filter.grow(6, 0.5);
  EXPECT_NEAR(filter.posterior().places[5], 0.25, 1e-12);
  EXPECT_NEAR(filter.posterior().places[1], 0.5 * before.places[1], 1e-12);
  EXPECT_THROW(filter.grow(2, 0.5), std::invalid_argument);
  EXPECT_THROW(filter.grow(9, 1.5), std::invalid_argument);
}

TEST(BayesFilter, FirstPlaceOfAnEmptyMap) {
  BayesFilter mapping({}, true), frozen({}, false);
  mapping.predict({});
  mapping.update({});
  EXPECT_EQ(mapping.best(), -1);
  mapping.grow(1, 1.0);
  EXPECT_EQ(mapping.posterior().places[0], 1.0);
  frozen.grow(1, 0.3);
  EXPECT_EQ(frozen.posterior().places[0], 1.0);
}

TEST(BayesFilter, SumsTheNeighbourhood) {
  BayesFilter filter({}, false);
  filter.reset(5);
  Likelihood l;
  l.places = {0.1, 0.2, 0.4, 0.2, 0.1};
  filter.update(l);
  const auto graph = ring(5);
  EXPECT_NEAR(filter.neighbourhoodMass(graph, 2, 0), 0.4, 1e-12);
  EXPECT_NEAR(filter.neighbourhoodMass(graph, 2, 1), 0.8, 1e-12);
  EXPECT_NEAR(filter.neighbourhoodMass(graph, 0, 1), 0.4, 1e-12);
  EXPECT_NEAR(filter.neighbourhoodMass(graph, 0, 2), 1.0, 1e-12);
}

// F-E14.
TEST(BayesFilter, InterpolatesThePeakBetweenPlaces) {
  BayesFilter filter({}, false);
  filter.reset(5);
  Likelihood l;
  l.places = {0.0, 0.1, 0.5, 0.4, 0.0};
  filter.update(l);
  EXPECT_EQ(filter.best(), 2);
  EXPECT_NEAR(filter.interpolatedPeak(chain(5), 2), 2.3, 1e-12);
  EXPECT_NEAR(filter.interpolatedPeak(Adjacency::fromEdges(5, {}), 2), 2.0, 1e-12);
}

TEST(BayesFilter, RefusesBadInput) {
  BayesFilter filter({}, true);
  filter.reset(3);
  EXPECT_THROW(filter.predict(chain(4)), std::invalid_argument);
  EXPECT_THROW(filter.predict(chain(3), {-1.0}), std::invalid_argument);
  EXPECT_THROW(filter.predict(chain(3), {static_cast<double>(NAN)}), std::invalid_argument);
  EXPECT_THROW(filter.update(at(4, 0)), std::invalid_argument);
  for (const double bad : {-0.1, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    auto l = at(3, 0);
    l.places[1] = bad;
    EXPECT_THROW(filter.update(l), std::invalid_argument);
    l = at(3, 0);
    l.newPlace = bad;
    EXPECT_THROW(filter.update(l), std::invalid_argument);
  }
  BeliefParams params;
  params.sigma_hops = 0;
  EXPECT_THAT([&] { BayesFilter(params, false); },
              testing::ThrowsMessage<base::ConfigError>(HasSubstr("sigma_hops")));
}

/// D-03: each image by itself.
TEST(WinnerTakesAll, TheMostLikelyPlaceOfTheLastImageHasEverything) {
  BeliefParams params;
  params.filter = "winner_takes_all";
  for (const std::string advance : {"none", "learned", "odometry"}) {
    params.advance = advance;
    BayesFilter filter(params, false);
    const Adjacency chain =
        Adjacency::fromEdges(5, std::vector<std::pair<int, int>>{{0, 1}, {1, 2}, {2, 3}, {3, 4}});
    filter.reset(5);
    for (const std::size_t place : {4u, 0u, 3u, 3u, 1u}) {
      filter.predict(chain);
      ASSERT_TRUE(filter.update(at(5, place, 0.999)));
      for (std::size_t i = 0; i < 5; ++i)
        EXPECT_NEAR(filter.posterior().places[i], i == place ? 1.0 : 0.0, 1e-12) << advance;
    }
  }
}

TEST(WinnerTakesAll, TheNewPlaceWinsOnlyWhereItIsMoreLikely) {
  BeliefParams params;
  params.filter = "winner_takes_all";
  BayesFilter filter(params, true);
  filter.reset(3);
  filter.update({.places = {0.2, 0.5, 0.5}, .newPlace = 0.5});
  EXPECT_EQ(filter.posterior().places, (std::vector<double>{0, 1, 0}));
  filter.update({.places = {0.2, 0.5, 0.5}, .newPlace = 0.6});
  EXPECT_EQ(filter.posterior().newPlace, 1);
  filter.update({.places = {0.7, 0.5, 0.5}, .newPlace = 0.6});
  EXPECT_EQ(filter.posterior().places, (std::vector<double>{1, 0, 0}));
}

}  // namespace
}  // namespace engram::belief

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/likelihood.h"

#include "worlds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace engram::belief {
namespace {

using testing::Each;

BeliefParams pointwise(const std::string& form) {
  BeliefParams params;
  params.likelihood = form;
  params.sum_of_gaussians = false;
  return params;
}

BeliefParams sumOfGaussians() {
  BeliefParams params;
  params.likelihood = "gaussian";
  return params;
}

/// The form of our own, without what neighbours share.
BeliefParams standingOut() {
  BeliefParams params;
  params.likelihood = "standardised";
  params.peak_sigma = 0.05;
  return params;
}

/// Places of a building that the image does not show.
std::vector<double> background(std::size_t n, base::Rng& rng) {
  std::vector<double> s(n);
  for (double& x : s) x = 0.1 + 0.01 * rng.normal();
  return s;
}

std::vector<double> randomSimilarities(std::size_t n, base::Rng& rng) {
  std::vector<double> s(n);
  for (double& x : s) x = 0.6 * rng.uniform();
  return s;
}

// F-E1: as printed the best match would get the lowest likelihood.
TEST(Likelihood, IncreasesWithTheSimilarity) {
  std::vector<double> s;
  for (int i = 0; i <= 20; ++i) s.push_back(i / 20.0);
  for (const char* form : {"gaussian", "exponential"}) {
    auto params = pointwise(form);
    params.sigma_z = 0.3;
    const auto l = likelihood(s, chain(21), params);
    EXPECT_TRUE(std::adjacent_find(l.places.begin(), l.places.end(), std::greater_equal<>()) ==
                l.places.end())
        << form;
    EXPECT_DOUBLE_EQ(l.places.back(), 1.0);
  }
  const auto l = likelihood(s, chain(21), pointwise("angeli"));
  EXPECT_TRUE(std::is_sorted(l.places.begin(), l.places.end()));
}

TEST(Likelihood, IsTheClosedFormOfEquationNine) {
  auto params = pointwise("gaussian");
  params.sigma_z = 0.5;
  params.floor = 1e-12;
  const std::vector<double> s{0.9, 0.4};
  const auto gaussian = likelihood(s, chain(2), params);
  EXPECT_NEAR(gaussian.places[1], std::exp((0.01 - 0.36) / (2 * 0.25)), 1e-9);
  params.likelihood = "exponential";
  const auto exponential = likelihood(s, chain(2), params);
  EXPECT_NEAR(exponential.places[1], std::exp((0.4 - 0.9) / 0.25), 1e-9);
}

TEST(Likelihood, IsPositiveFiniteAndAtMostOneForAnyInput) {
  base::Rng rng(2);
  for (const char* form : {"gaussian", "exponential", "angeli"})
    for (const bool sum : {false, true})
      for (int trial = 0; trial < 50; ++trial) {
        auto params = pointwise(form);
        params.sum_of_gaussians = sum;
        params.sigma_z = trial % 2 ? 0.0 : 1e-4;  // would underflow without logarithms
        const auto l = likelihood(randomSimilarities(30, rng), randomGraph(30, 3, rng), params);
        double largest = l.newPlace;
        for (const double p : l.places) {
          ASSERT_GT(p, 0.0);
          largest = std::max(largest, p);
        }
        ASSERT_GT(l.newPlace, 0.0);
        EXPECT_DOUBLE_EQ(largest, 1.0);
      }
}

TEST(Likelihood, SaysNothingAboutPlacesWhenNothingMatches) {
  const std::vector<double> none(5, 0.0);
  for (const char* form : {"gaussian", "exponential", "angeli"}) {
    for (const bool sum : {false, true}) {
      auto params = pointwise(form);
      params.sum_of_gaussians = sum;
      const auto l = likelihood(none, chain(5), params);
      EXPECT_THAT(l.places, Each(l.places[0])) << form;
      EXPECT_GE(l.newPlace, l.places[0]) << "an image like no other speaks for a new place";
    }
  }
  EXPECT_TRUE(likelihood({}, chain(0), {}).places.empty());
}

TEST(Likelihood, TheNewPlaceCountsAsAPlaceOfItsSimilarity) {
  auto params = pointwise("gaussian");
  params.new_place_similarity = 0.4;
  const auto l = likelihood(std::vector<double>{0.1, 0.4, 0.8}, chain(3), params);
  EXPECT_DOUBLE_EQ(l.newPlace, l.places[1]);
}

TEST(Likelihood, DoesNotDependOnTheNumbersOfThePlaces) {
  base::Rng rng(3);
  bool ours = true;
  for (const bool sum : {false, true, true}) {
    BeliefParams params;
    if (!std::exchange(ours, false)) params = pointwise("gaussian");
    params.sum_of_gaussians = sum;
    const auto graph = randomGraph(12, 4, rng);
    const auto s = randomSimilarities(12, rng);
    std::vector<int> to(12);
    std::iota(to.begin(), to.end(), 0);
    for (std::uint32_t i = 12; i > 1; --i) std::swap(to[i - 1], to[rng.below(i)]);
    std::vector<std::pair<int, int>> edges;
    std::vector<double> permuted(12);
    for (std::size_t i = 0; i < 12; ++i) {
      permuted[static_cast<std::size_t>(to[i])] = s[i];
      for (const int j : graph.neighbours[i]) edges.emplace_back(to[i], to[static_cast<std::size_t>(j)]);
    }
    const auto a = likelihood(s, graph, params);
    const auto b = likelihood(permuted, Adjacency::fromEdges(12, edges), params);
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_NEAR(a.places[i], b.places[static_cast<std::size_t>(to[i])], 1e-12);
  }
}

// F-E12 against brute force over all pairs.
TEST(SumOfGaussians, IsEquationElevenOnThePeaks) {
  base::Rng rng(4);
  BeliefParams params = sumOfGaussians();
  params.floor = 1e-12;
  params.new_place_similarity = 0.0;
  for (int trial = 0; trial < 20; ++trial) {
    const auto graph = randomGraph(20, 4, rng);
    const auto hops = allHops(graph);
    const auto s = randomSimilarities(20, rng);
    const double bound = *std::max_element(s.begin(), s.end()) - similaritySpread(s, params);
    std::vector<double> expected(20, 0.0);
    for (std::size_t l = 0; l < 20; ++l) {
      bool peak = s[l] >= bound;
      for (const int j : graph.neighbours[l]) peak = peak && s[static_cast<std::size_t>(j)] <= s[l];
      for (std::size_t x = 0; peak && x < 20; ++x)
        if (hops[l][x] <= 4) expected[x] += s[l] * std::exp(-0.5 * hops[l][x] * hops[l][x]);
    }
    const double largest = *std::max_element(expected.begin(), expected.end());
    const auto l = likelihood(s, graph, params);
    for (std::size_t x = 0; x < 20; ++x) EXPECT_NEAR(l.places[x], expected[x] / largest, 1e-9);
  }
}

TEST(SumOfGaussians, KeepsEveryHypothesisNearTheMaximum) {
  std::vector<double> s(30, 0.1);
  s[5] = 0.50;
  s[20] = 0.48;
  s[28] = 0.30;  // further than sigma_z from the maximum
  BeliefParams params = sumOfGaussians();
  params.sigma_z = 0.1;
  const auto l = likelihood(s, chain(30), params);
  EXPECT_NEAR(l.places[5], 1.0, 1e-12);
  EXPECT_NEAR(l.places[20], 0.96, 0.01);
  EXPECT_NEAR(l.places[21], 0.96 * std::exp(-0.5), 0.01);
  EXPECT_NEAR(l.places[28], params.floor, 1e-3);
}

TEST(Angeli, FollowsItsRuleAndGuardsItsDivisions) {
  const std::vector<double> s{0.1, 0.1, 0.1, 0.7};
  auto params = pointwise("angeli");
  params.floor = 1e-12;
  const double mean = 0.25, sigma = std::sqrt((3 * 0.15 * 0.15 + 0.45 * 0.45) / 4);
  const double best = (0.7 - sigma) / mean, other = mean / sigma + 1;
  const auto l = likelihood(s, chain(4), params);
  const double largest = std::max(best, other);
  EXPECT_NEAR(l.places[3], best / largest, 1e-9);
  EXPECT_NEAR(l.places[0], 1 / largest, 1e-9);
  EXPECT_NEAR(l.newPlace, other / largest, 1e-9);
  const auto equal = likelihood(std::vector<double>(4, 0.3), chain(4), params);
  EXPECT_THAT(equal.places, Each(1.0));
  EXPECT_EQ(equal.newPlace, 1.0);
}

TEST(Standardised, IsTheDistanceFromTheMedianInNormalDeviates) {
  base::Rng rng(5);
  auto params = standingOut();
  params.sigma_z_min = 1e-4;
  auto s = background(20001, rng);
  s[7] = 0.2;
  const auto z = standardised(s, params);
  EXPECT_NEAR(z[7], 10, 0.3);
  double squares = 0;
  for (std::size_t i = 0; i < z.size(); ++i) squares += i == 7 ? 0 : z[i] * z[i];
  EXPECT_NEAR(squares / static_cast<double>(z.size()), 1, 0.05);
  params.sigma_z_min = 0.05;
  EXPECT_NEAR(standardised(s, params)[7], 2, 0.01) << "the spread has a lower bound";
}

// By night all similarities are small, and their differences too.
TEST(Standardised, TellsByNightWhatItTellsByDay) {
  base::Rng rng(6);
  auto params = standingOut();
  params.sigma_z_min = 1e-4;
  auto day = background(200, rng);
  day[50] = 0.5;
  std::vector<double> night;
  for (const double s : day) night.push_back(0.02 + 0.2 * s);
  const auto a = likelihood(day, chain(200), params);
  params.new_place_similarity = 0.02 + 0.2 * params.new_place_similarity;
  const auto b = likelihood(night, chain(200), params);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_NEAR(a.places[i], b.places[i], 1e-9);
  EXPECT_NEAR(a.newPlace, b.newPlace, 1e-9);
}

// A share of the whole evidence says nothing, not a share of that for each place.
TEST(Standardised, ALoneRightPlaceIsBelievedInAMapOfAnySize) {
  base::Rng rng(7);
  for (const std::size_t n : {2u, 20u, 200u, 2000u, 20000u}) {
    auto params = standingOut();
    params.evidence = 1;  // enough for any of these
    auto s = background(n, rng);
    s[1] = 0.9;
    const auto l = likelihood(s, Adjacency::fromEdges(n, {}), params);
    const double total = std::accumulate(l.places.begin(), l.places.end(), 0.0);
    const double others = 1 - 1 / static_cast<double>(n);  // its own share of what says nothing is its own
    EXPECT_NEAR(l.places[1] / total, 1 - params.background * others, 1e-3) << n;
    EXPECT_NEAR(static_cast<double>(n) * l.floor / total, params.background, 1e-9) << n;
  }
}

TEST(Standardised, AnImageOfNowhereSpeaksNeitherForNorAgainstANewPlace) {
  base::Rng rng(8);
  const auto params = standingOut();
  auto wide = params;
  wide.sigma_z_min = 1e-4;
  const auto l = likelihood(background(20000, rng), Adjacency::fromEdges(20000, {}), wide);
  const double mean = std::accumulate(l.places.begin(), l.places.end(), 0.0) / 20000;
  EXPECT_NEAR(l.newPlace / mean, 1, 0.02);
  std::vector<double> known = background(200, rng);
  known[3] = 0.5;
  const auto seen = likelihood(known, Adjacency::fromEdges(200, {}), params);
  EXPECT_GT(seen.places[3], 100 * seen.newPlace);
}

TEST(Standardised, IncreasesWithTheSimilarity) {
  std::vector<double> s;
  for (int i = 0; i <= 20; ++i) s.push_back(i / 20.0);
  const auto l = likelihood(s, Adjacency::fromEdges(21, {}), standingOut());
  EXPECT_TRUE(std::adjacent_find(l.places.begin(), l.places.end(), std::greater_equal<>()) == l.places.end());
  EXPECT_DOUBLE_EQ(std::max(l.places.back(), l.newPlace), 1.0);
}

// Against the transition matrix of a symmetric random walk (Metropolis), step by step.
TEST(Standardised, NeighboursShareTheEvidenceByDiffusion) {
  base::Rng rng(9);
  const auto graph = randomGraph(15, 5, rng);
  const auto s = randomSimilarities(15, rng);
  auto params = standingOut();
  params.background = 1e-6;
  params.peak_sigma = 1;  // two steps of variance 1/2
  Eigen::MatrixXd step = Eigen::MatrixXd::Zero(15, 15);
  for (int i = 0; i < 15; ++i) {
    const auto& near = graph.neighbours[static_cast<std::size_t>(i)];
    step(i, i) = 1;
    for (const int j : near) {
      const auto edges = std::max(near.size(), graph.neighbours[static_cast<std::size_t>(j)].size());
      step(i, j) = 0.5 / static_cast<double>(edges);
      step(i, i) -= step(i, j);
    }
  }
  const auto z = standardised(s, params);
  const Eigen::VectorXd expected =
      (params.evidence * step * step * Eigen::Map<const Eigen::VectorXd>(z.data(), 15)).array().exp();
  const auto l = likelihood(s, graph, params);
  for (int i = 1; i < 15; ++i)
    EXPECT_NEAR(l.places[static_cast<std::size_t>(i)] / l.places[0], expected[i] / expected[0],
                1e-4 * expected[i] / expected[0]);
}

TEST(SimilaritySpread, IsTheStandardDeviationWithALowerBound) {
  BeliefParams params;
  EXPECT_NEAR(similaritySpread(std::vector<double>{0.2, 0.6}, params), 0.2, 1e-12);
  EXPECT_EQ(similaritySpread(std::vector<double>{0.2, 0.2}, params), params.sigma_z_min);
  EXPECT_EQ(similaritySpread({}, params), params.sigma_z_min);
  params.sigma_z = 0.7;
  EXPECT_EQ(similaritySpread(std::vector<double>{0.2, 0.2}, params), 0.7);
}

TEST(Likelihood, RefusesWhatIsNoSimilarity) {
  for (const double bad : {-0.1, 1.1, static_cast<double>(NAN)})
    EXPECT_THROW(likelihood(std::vector<double>{0.1, bad}, chain(2), {}), std::invalid_argument);
  EXPECT_THROW(likelihood(std::vector<double>{0.1}, chain(2), {}), std::invalid_argument);
}

}  // namespace
}  // namespace engram::belief

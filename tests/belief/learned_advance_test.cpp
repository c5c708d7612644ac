// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A robot that drives along a chain of places with noisy recognition: a filter that learns how far it moves
// for each image against one that does not.
#include "worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace engram::belief::learned_advance {
namespace {

constexpr int kPlaces = 120;

/// A map where places look alike: the true place is often not the most similar one.
std::vector<double> similarities(int truth, double contrast, base::Rng& rng) {
  std::vector<double> s(kPlaces);
  for (int i = 0; i < kPlaces; ++i) {
    const double d = i - truth;
    const double signal = contrast * std::exp(-0.5 * d * d / (1.5 * 1.5));
    s[static_cast<std::size_t>(i)] = std::clamp(0.15 + signal + 0.06 * rng.normal(), 0.0, 1.0);
  }
  return s;
}

struct Walk {
  std::vector<int> truth;  ///< place at each image
  int from = 0;            ///< first image that counts
};

Walk forward() {
  Walk walk;
  for (int t = 0; t < 90; ++t) walk.truth.push_back(5 + t);
  walk.from = 5;
  return walk;
}
Walk halfSpeed() {
  Walk walk;
  for (int t = 0; t < 120; ++t) walk.truth.push_back(5 + t / 2);
  walk.from = 5;
  return walk;
}
Walk backward() {
  Walk walk = forward();
  std::reverse(walk.truth.begin(), walk.truth.end());
  return walk;
}
Walk stopsAndReverses() {
  Walk walk;
  for (int t = 0; t < 40; ++t) walk.truth.push_back(30 + t);
  for (int t = 0; t < 20; ++t) walk.truth.push_back(69);
  for (int t = 0; t < 40; ++t) walk.truth.push_back(69 - t);
  walk.from = 40;  // from the stop on
  return walk;
}
Walk randomWalk(std::uint64_t seed) {
  base::Rng rng(seed);
  Walk walk;
  for (int t = 0, x = 60; t < 120; ++t) {
    walk.truth.push_back(x);
    x = std::clamp(x + static_cast<int>(rng.below(5)) - 2, 0, kPlaces - 1);
  }
  walk.from = 5;
  return walk;
}

/// Share of the images whose best guess is the true place or next to it.
double success(const std::string& advance, const std::function<Walk(std::uint64_t)>& make,
               double contrast = 0.12) {
  const auto graph = chain(kPlaces);
  BeliefParams params;
  params.advance = advance;
  params.likelihood = "gaussian";
  int right = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    base::Rng rng(seed);
    const Walk walk = make(seed);
    BayesFilter filter(params, false);
    filter.reset(kPlaces);
    for (int t = 0; t < static_cast<int>(walk.truth.size()); ++t) {
      const int truth = walk.truth[static_cast<std::size_t>(t)];
      filter.predict(graph);
      filter.update(likelihood(similarities(truth, contrast, rng), graph, params));
      if (t < walk.from) continue;
      ++count;
      right += std::abs(filter.best() - truth) <= 1;
    }
  }
  return static_cast<double>(right) / count;
}

struct Pair {
  double blind, learned;
};
Pair compare(const std::string& name, const std::function<Walk(std::uint64_t)>& make) {
  const Pair p{success("none", make), success("learned", make)};
  testing::Test::RecordProperty(name + "_blind", std::to_string(p.blind));
  testing::Test::RecordProperty(name + "_learned", std::to_string(p.learned));
  return p;
}

TEST(LearnedAdvance, BeatsTheBlindFilterOnASteadyWalk) {
  for (const auto& [name, make] :
       {std::pair{"forward", &forward}, {"backward", &backward}, {"half_speed", &halfSpeed}}) {
    const auto p = compare(name, [make = make](std::uint64_t) { return make(); });
    EXPECT_GT(p.learned, p.blind + 0.05) << name;
  }
}

TEST(LearnedAdvance, IsNotMuchWorseWhenTheRobotStopsAndTurnsBack) {
  const auto p = compare("reverse", [](std::uint64_t) { return stopsAndReverses(); });
  EXPECT_GT(p.learned, p.blind - 0.02);
}

// Every step between -2 and 2 with equal probability: the memory of the last step can only mislead.
TEST(LearnedAdvance, LosesLittleWhereThereIsNothingToLearn) {
  const auto p = compare("random", randomWalk);
  EXPECT_GT(p.learned, p.blind - 0.07);
}

TEST(LearnedAdvance, FindsTheStepAndForgetsIt) {
  const auto graph = chain(kPlaces);
  BayesFilter filter({}, false);
  filter.reset(kPlaces);
  base::Rng rng(5);
  const auto probability = [&](double low, double high) {
    double sum = 0;
    for (const auto& step : filter.learntSteps())
      if (step.size >= low && step.size <= high) sum += step.probability;
    return sum;
  };
  const auto drive = [&](double from, double step, int images) {
    for (int t = 0; t < images; ++t) {
      filter.predict(graph);
      const int truth = static_cast<int>(std::lround(from + step * t));
      filter.update(likelihood(similarities(truth, 0.4, rng), graph, filter.params()));
    }
  };
  EXPECT_NEAR(probability(-3, 3), 1, 1e-12);
  EXPECT_NEAR(probability(-3, -1), probability(1, 3), 1e-12) << "symmetric at first";
  drive(10, 2, 40);
  EXPECT_GT(probability(1.5, 2.5), 0.7);
  drive(88, 0, 20);
  EXPECT_GT(probability(-0.5, 0.5), 0.6);
  drive(88, -1, 30);
  EXPECT_GT(probability(-1.5, -0.5), 0.7);
  drive(58, 0.5, 40);
  EXPECT_GT(probability(0.25, 0.75), 0.6);
  filter.reset(kPlaces);
  EXPECT_NEAR(probability(-3, -1), probability(1, 3), 1e-12);
}

}  // namespace
}  // namespace engram::belief::learned_advance

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

namespace engram::belief {
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
  int right = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
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
  std::printf("%s: blind %.3f, learned %.3f\n", name.c_str(), p.blind, p.learned);
  return p;
}

TEST(LearnedAdvance, BeatsTheBlindFilterOnASteadyWalk) {
  for (const auto& [name, make] :
       {std::pair{"forward", &forward}, {"backward", &backward}, {"half_speed", &halfSpeed}}) {
    const auto p = compare(name, [make = make](std::uint64_t) { return make(); });
    EXPECT_GT(p.learned, p.blind) << name;
  }
}

TEST(LearnedAdvance, IsNotMuchWorseWhenTheRobotStopsAndTurnsBack) {
  const auto p = compare("reverse", [](std::uint64_t) { return stopsAndReverses(); });
  EXPECT_GT(p.learned, p.blind - 0.02);
}

TEST(LearnedAdvance, IsNotMuchWorseWhereThereIsNothingToLearn) {
  const auto p = compare("random", randomWalk);
  EXPECT_GT(p.learned, p.blind - 0.03);
}

TEST(LearnedAdvance, FindsTheStepAndForgetsIt) {
  const auto graph = chain(kPlaces);
  BeliefParams params;
  params.advance = "learned";
  BayesFilter filter(params, false);
  filter.reset(kPlaces);
  base::Rng rng(5);
  EXPECT_NEAR(filter.stepProbabilities()[2], filter.stepProbabilities()[4], 1e-12) << "symmetric at first";
  const auto drive = [&](int from, int step, int images) {
    for (int t = 0; t < images; ++t) {
      filter.predict(graph);
      filter.update(likelihood(similarities(from + step * t, 0.4, rng), graph, params));
    }
  };
  const auto mostProbable = [&] {
    const auto& p = filter.stepProbabilities();
    return static_cast<int>(std::max_element(p.begin(), p.end()) - p.begin()) - params.advance_max;
  };
  drive(10, 2, 40);
  EXPECT_EQ(mostProbable(), 2);
  EXPECT_GT(filter.stepProbabilities()[5], 0.5);
  drive(88, 0, 20);
  EXPECT_EQ(mostProbable(), 0);
  drive(88, -1, 40);
  EXPECT_EQ(mostProbable(), -1);
  filter.reset(kPlaces);
  EXPECT_NEAR(filter.stepProbabilities()[2], filter.stepProbabilities()[4], 1e-12);
}

}  // namespace
}  // namespace engram::belief

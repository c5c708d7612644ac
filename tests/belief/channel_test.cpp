// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/channel.h"

#include "worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>

namespace engram::belief {
namespace {

constexpr int kPlaces = 60;

BeliefParams params() {
  BeliefParams p;
  p.peak_sigma = 0.05;
  p.sigma_z_min = 1e-3;
  return p;
}

/// Similarities of a channel to which the place stands out by so many normal deviates.
std::vector<double> look(int place, double deviates, base::Rng& rng) {
  std::vector<double> s(kPlaces);
  for (double& x : s) x = std::clamp(0.2 + 0.02 * rng.normal(), 0.0, 1.0);
  s[static_cast<std::size_t>(place)] = 0.2 + 0.02 * deviates;
  return s;
}

/// A robot goes from place to place while two channels look; how often the filter was right.
int drive(Channel& sure, Channel& other, const std::function<std::vector<double>(int, base::Rng&)>& otherSees,
          std::uint64_t seed) {
  base::Rng rng(seed);
  const Adjacency places = ring(kPlaces);
  BayesFilter filter(params(), false);
  filter.reset(kPlaces);
  int right = 0;
  for (int i = 0; i < 100; ++i) {
    const int here = i % kPlaces;
    filter.predict(places);
    const Likelihood a = sure.likelihood(look(here, 12, rng), places);
    const Likelihood b = other.likelihood(otherSees(here, rng), places);
    filter.update(a);
    filter.update(b);
    sure.learn(a, filter.posterior());
    other.learn(b, filter.posterior());
    right += filter.best() == here;
  }
  return right;
}

TEST(Channel, OneThatTellsThePlacesApartIsTrusted) {
  Channel sure(params(), 0.5), other(params(), 0.5);
  EXPECT_GE(drive(
                sure, other, [](int here, base::Rng& rng) { return look(here, 12, rng); }, 1),
            95);
  EXPECT_GT(sure.trust(), 0.9);
  EXPECT_GT(other.trust(), 0.9);
}

TEST(Channel, OneThatSeesNothingLosesItsWeight) {
  Channel sure(params(), 0.5), other(params(), 0.5);
  const auto nothing = [](int, base::Rng& rng) { return look(0, 0, rng); };
  EXPECT_GE(drive(sure, other, nothing, 2), 95);
  EXPECT_GT(sure.trust(), 0.9);
  EXPECT_LT(other.trust(), 0.5);
}

TEST(Channel, OneThatTellsAnotherStoryAtEachImageLosesItsWeight) {
  Channel sure(params(), 0.5), other(params(), 0.5);
  const auto anywhere = [](int, base::Rng& rng) {
    return look(static_cast<int>(rng.below(kPlaces)), 12, rng);
  };
  EXPECT_GE(drive(sure, other, anywhere, 3), 85);
  EXPECT_GT(sure.trust(), 0.9);
  EXPECT_LT(other.trust(), 0.2);
}

/// A place that looks like every image, more than the right one does: how often the filter is right in the
/// second half of a drive.
TEST(Channel, APlaceThatLooksLikeEverythingLosesItsWeight) {
  base::Rng rng(5);
  const Adjacency places = ring(kPlaces);
  const auto seen = [&](int here) {
    std::vector<double> s = look(here, 6, rng);
    s[7] = std::max(s[7], 0.2 + 0.02 * (9 + rng.normal()));
    return s;
  };
  int corrected = 0, plain = 0;
  for (const bool watches : {true, false}) {
    Channel channel(params(), 0.9);
    for (int i = 0; i < 2 * kPlaces; ++i) {
      const int here = i % kPlaces;
      const auto s = seen(here);
      const Likelihood l = channel.likelihood(s, places);
      const auto best = std::max_element(l.places.begin(), l.places.end()) - l.places.begin();
      if (i >= kPlaces && here != 7) (watches ? corrected : plain) += best == here;
      if (watches) channel.watch(s);
    }
  }
  EXPECT_GE(corrected, 50);
  EXPECT_LE(plain, 5);
}

TEST(Channel, ARobotThatStandsKeepsItsPlace) {
  base::Rng rng(6);
  Channel channel(params(), 0.9);
  const auto s = look(20, 8, rng);
  for (int i = 0; i < 200; ++i) channel.watch(s);
  const Likelihood l = channel.likelihood(s, ring(kPlaces));
  EXPECT_EQ(std::max_element(l.places.begin(), l.places.end()) - l.places.begin(), 20);
}

TEST(Channel, WhatItDoesNotVouchForIsTheSameForAllPlaces) {
  base::Rng rng(4);
  for (const double trust : {0.1, 0.5, 0.9}) {
    const Channel channel(params(), trust);
    const Likelihood l = channel.likelihood(look(5, 8, rng), ring(kPlaces));
    const double total = std::accumulate(l.places.begin(), l.places.end(), 0.0);
    EXPECT_NEAR(kPlaces * l.floor / total, 1 - trust, 1e-9);
    EXPECT_GE(*std::min_element(l.places.begin(), l.places.end()), l.floor);
  }
}

}  // namespace
}  // namespace engram::belief

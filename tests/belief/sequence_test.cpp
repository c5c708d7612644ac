// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/sequence.h"

#include "worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace engram::belief {
namespace {

constexpr int kPlaces = 200, kImages = 10, kAround = 4;
constexpr double kSignificant = -5;

std::vector<double> noise(int n, base::Rng& rng) {
  std::vector<double> z(static_cast<std::size_t>(n));
  for (double& x : z) x = rng.normal();
  return z;
}

/// What a robot that goes from place to place sees: so many deviates beside the noise.
Sequence driven(int first, int images, double deviates, base::Rng& rng, const Adjacency& places) {
  Sequence sequence(kImages);
  for (int i = 0; i < images; ++i) {
    std::vector<double> z = noise(kPlaces, rng);
    z[static_cast<std::size_t>(first + i)] += deviates;
    sequence.add(z, places, 1);
  }
  return sequence;
}

/// The best of all ways that end at a place, one after the other.
double bestWay(const std::vector<std::vector<double>>& z, std::size_t image, int place,
               const Adjacency& places) {
  const double here = z[image][static_cast<std::size_t>(place)];
  if (image == 0) return here;
  double before = bestWay(z, image - 1, place, places);
  for (const int next : places.neighbours[static_cast<std::size_t>(place)])
    before = std::max(before, bestWay(z, image - 1, next, places));
  return here + (1.0 - 1.0 / kImages) * before;
}

TEST(Sequence, AddsUpAlongTheBestOfAllWays) {
  base::Rng rng(1);
  const Adjacency places = randomGraph(9, 4, rng);
  Sequence sequence(kImages);
  std::vector<std::vector<double>> z;
  for (std::size_t image = 0; image < 6; ++image) {
    z.push_back(noise(9, rng));
    sequence.add(z.back(), places, 1);
    int best = 0;
    for (int i = 1; i < 9; ++i)
      if (bestWay(z, image, i, places) > bestWay(z, image, best, places)) best = i;
    EXPECT_EQ(sequence.peak(places, 0).place, best) << "image " << image;
  }
}

TEST(Sequence, FindsWhatNoImageAloneTells) {
  const Adjacency places = chain(kPlaces);
  int found = 0, alone = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    base::Rng rng(seed);
    const auto peak = driven(20, 30, 4, rng, places).peak(places, kAround);
    found += std::abs(peak.place - 49) <= 1 && peak.log10Nfa <= kSignificant;
    const auto one = driven(20, 1, 4, rng, places).peak(places, kAround);
    alone += one.place == 20 && one.log10Nfa <= kSignificant;
  }
  EXPECT_GE(found, 45);
  EXPECT_LE(alone, 5);
}

TEST(Sequence, NoiseIsNoEvidenceHoweverLong) {
  const Adjacency places = chain(kPlaces);
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    base::Rng rng(seed);
    const auto peak = driven(20, 60, 0, rng, places).peak(places, kAround);
    EXPECT_GT(peak.log10Nfa, kSignificant) << "seed " << seed;
  }
}

TEST(Sequence, WhatIsAlikeElsewhereIsARival) {
  const Adjacency places = chain(kPlaces);
  base::Rng rng(3);
  Sequence sequence(kImages);
  for (int i = 0; i < 20; ++i) {
    std::vector<double> z = noise(kPlaces, rng);
    for (const int storey : {0, 100}) z[static_cast<std::size_t>(storey + 30 + i)] += 6;
    sequence.add(z, places, 1);
  }
  const auto peak = sequence.peak(places, kAround);
  EXPECT_LE(peak.log10Nfa, kSignificant);
  EXPECT_GT(peak.rival, 0.8 * peak.deviates);
  const auto single = driven(30, 20, 6, rng, places).peak(places, kAround);
  EXPECT_LT(single.rival, 0.8 * single.deviates);
}

TEST(Sequence, SaysNothingBeforeItHasSeenEnoughAndAfterTheMapHasGrown) {
  base::Rng rng(4);
  Sequence sequence(3);
  for (int i = 0; i < 2; ++i) sequence.add(noise(5, rng), chain(5), 1);
  EXPECT_FALSE(sequence.ready());
  sequence.add(noise(5, rng), chain(5), 1);
  EXPECT_TRUE(sequence.ready());
  sequence.add(noise(6, rng), chain(6), 1);
  EXPECT_FALSE(sequence.ready());
  sequence.reset();
  EXPECT_EQ(sequence.peak(chain(6), 1).place, -1);
  EXPECT_THROW(sequence.add(noise(4, rng), chain(5), 1), std::invalid_argument);
}

}  // namespace
}  // namespace engram::belief

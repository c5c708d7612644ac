// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Long lives of one place, simulated: features that are seen with known probabilities.
#include "make_features.h"

#include <gtest/gtest.h>

#include <set>

namespace engram::memory {
namespace {

struct World {
  int stable = 60, fickle = 60, clutter = 60;  ///< seen with probability 0.9, 0.3, and once only
  int nextClutter = 100000;

  types::Features view(base::Rng& rng, int from = 0) {
    std::vector<int> ids;
    std::vector<float> responses;
    const auto add = [&](int id) {
      ids.push_back(id);
      responses.push_back(static_cast<float>(0.1 + 0.9 * rng.uniform()));
    };
    for (int i = 0; i < stable; ++i)
      if (rng.uniform() < 0.9) add(from + i);
    for (int i = 0; i < fickle; ++i)
      if (rng.uniform() < 0.3) add(from + 1000 + i);
    for (int i = 0; i < clutter; ++i) add(nextClutter++);
    return makeFeatures(ids, responses);
  }
};

std::vector<types::Match> noisyMatches(const types::Features& view, const PlaceMemory& memory,
                                       base::Rng& rng) {
  auto matches = trueMatches(view, memory, 0.0f);
  for (auto& match : matches) match.distance = static_cast<float>(std::abs(rng.normal(0.2, 0.06)));
  return matches;
}

/// Share of the `n` best features that are among the stable ones of the world that begins at `from`.
double stableShare(const PlaceMemory& memory, int from, int count) {
  int hits = 0;
  for (const int i : memory.longTerm()) {
    const int id = static_cast<int>(memory.features.keypoints[static_cast<std::size_t>(i)].x);
    hits += id >= from && id < from + count;
  }
  return static_cast<double>(hits) / static_cast<double>(memory.longTerm().size());
}

FshParams lifeParams() {
  FshParams params;
  params.ltm_min_features = 50;
  params.max_features = 200;
  return params;
}

TEST(FshLife, LongTermMemoryConvergesToTheStableFeatures) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    base::Rng rng(seed);
    World world;
    const Fsh model(lifeParams());
    auto memory = model.start(world.view(rng));
    EXPECT_LT(stableShare(memory, 0, world.stable), 0.7) << "at first nothing is known but the strength";
    for (int n = 1; n < 40; ++n) {
      const auto view = world.view(rng);
      const std::size_t before = memory.features.size();
      const auto change = model.update(memory, view, noisyMatches(view, memory, rng));
      ASSERT_EQ(memory.features.size(),
                before + static_cast<std::size_t>(change.added) - static_cast<std::size_t>(change.pruned));
      ASSERT_EQ(change.longTerm + change.shortTerm, static_cast<int>(memory.features.size()));
      ASSERT_LE(memory.features.size(), 200u);
    }
    EXPECT_GT(stableShare(memory, 0, world.stable), 0.97) << "seed " << seed;
    EXPECT_GE(memory.longTerm().size(), 50u);
    EXPECT_LE(memory.longTerm().size(), 61u);
  }
}

// A refurnished place: new stable features must take over. With the paper's sums that takes about as long as
// the old life; with decay a fixed number of updates.
TEST(FshLife, ANewLookTakesOver) {
  const auto updatesToTakeOver = [](double decay, int oldLife) {
    base::Rng rng(7);
    World world;
    auto params = lifeParams();
    params.decay = decay;
    const Fsh model(params);
    auto memory = model.start(world.view(rng));
    for (int n = 1; n < oldLife; ++n) {
      const auto view = world.view(rng);
      model.update(memory, view, noisyMatches(view, memory, rng));
    }
    for (int n = 1; n <= 3 * oldLife; ++n) {
      const auto view = world.view(rng, 20000);
      model.update(memory, view, noisyMatches(view, memory, rng));
      if (stableShare(memory, 20000, world.stable) > 0.9) return n;
    }
    return 10 * oldLife;
  };
  const int paperShort = updatesToTakeOver(1.0, 20), paperLong = updatesToTakeOver(1.0, 80);
  EXPECT_LE(paperShort, 2 * 20);
  EXPECT_GT(paperLong, 2 * paperShort);
  EXPECT_LE(paperLong, 2 * 80);
  EXPECT_LE(updatesToTakeOver(0.9, 80), 15);
}

}  // namespace
}  // namespace engram::memory

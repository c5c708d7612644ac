// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/belief/adjacency.h"

#include "worlds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace engram::belief {
namespace {

TEST(Adjacency, IsUndirectedWithoutRepetitionsAndLoops) {
  const std::vector<std::pair<int, int>> edges{{2, 0}, {0, 2}, {1, 1}, {0, 1}};
  const auto a = Adjacency::fromEdges(4, edges);
  EXPECT_THAT(a.neighbours[0], testing::ElementsAre(1, 2));
  EXPECT_THAT(a.neighbours[1], testing::ElementsAre(0));
  EXPECT_THAT(a.neighbours[2], testing::ElementsAre(0));
  EXPECT_TRUE(a.neighbours[3].empty());
}

TEST(Adjacency, ChainsPlacesOfConsecutiveNumberThatShareAnEdge) {
  const std::vector<std::pair<int, int>> edges{{0, 1}, {2, 1}, {4, 3}, {0, 4}};
  const auto a = Adjacency::fromEdges(5, edges);
  EXPECT_THAT(a.successor, testing::ElementsAre(1, 2, -1, 4, -1));
  EXPECT_THAT(a.predecessor, testing::ElementsAre(-1, 0, 1, -1, 3));
  EXPECT_EQ(a.along(0, 2), 2);
  EXPECT_EQ(a.along(2, -2), 0);
  EXPECT_EQ(a.along(0, 3), -1);
  EXPECT_EQ(a.along(3, 0), 3);
}

TEST(Adjacency, RefusesAnEdgeToNowhere) {
  const std::vector<std::pair<int, int>> beyond{{0, 3}}, negative{{-1, 0}};
  EXPECT_THROW(Adjacency::fromEdges(3, beyond), std::invalid_argument);
  EXPECT_THROW(Adjacency::fromEdges(3, negative), std::invalid_argument);
}

TEST(HopSearch, AgreesWithAllShortestPaths) {
  base::Rng rng(1);
  for (int trial = 0; trial < 30; ++trial) {
    const auto graph = randomGraph(25, 6, rng);
    const auto oracle = allHops(graph);
    HopSearch search(graph);
    for (int repeat = 0; repeat < 2; ++repeat)  // the working memory is reused
      for (int i = 0; i < 25; ++i) {
        const int radius = static_cast<int>(rng.below(6));
        std::vector<int> found(25, 1 << 20);
        for (const auto& hop : search.within(i, radius))
          found[static_cast<std::size_t>(hop.place)] = hop.hops;
        for (std::size_t j = 0; j < 25; ++j) {
          const int expected = oracle[static_cast<std::size_t>(i)][j];
          ASSERT_EQ(found[j], expected <= radius ? expected : 1 << 20);
        }
      }
  }
}

// F-E2: by index, the two ends of a loop are far apart.
TEST(HopDistance, CrossesTheSeamOfARing) {
  EXPECT_EQ(hopDistance(ring(20), 1, 19, 5), 2);
  EXPECT_EQ(hopDistance(chain(20), 1, 19, 5), -1);
  EXPECT_EQ(hopDistance(chain(20), 1, 19, 18), 18);
}

}  // namespace
}  // namespace engram::belief

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/diff.h"

#include "keeper_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram::keeper {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const KindDifference& of(const Difference& d, const std::string& kind) {
  for (const KindDifference& k : d.kinds)
    if (k.kind == kind) return k;
  throw std::out_of_range(kind);
}

TEST(Diff, AMapEqualsItself) {
  const store::WholeMap a = testing::twoDrives(12, 3);
  const Difference d = diff(a, a);
  EXPECT_TRUE(d.same());
  EXPECT_EQ(of(d, "places").equal, 16u);
  EXPECT_EQ(of(d, "memories").equal, 16u);
}

TEST(Diff, EachChangeIsNamedOnceAndTheOtherWayRound) {
  const store::WholeMap a = testing::twoDrives(12, 3);
  store::WholeMap b = a;
  b.content.places.at(map::PlaceId(4)).T_map_place.translation().x() += 0.5;
  b.content.places.at(map::PlaceId(5)).memory.edit().states[0].value += 1;
  b.content.edges.erase(map::EdgeId(2));
  b.content.path.pop_back();
  b.header.parameters = "[place]\nspacing = 0.9\n";
  const Difference d = diff(a, b);
  EXPECT_FALSE(d.same());
  EXPECT_THAT(of(d, "places").changed, ElementsAre(4));
  EXPECT_THAT(of(d, "memories").changed, ElementsAre(5));
  EXPECT_THAT(of(d, "edges").onlyA, ElementsAre(2));
  EXPECT_THAT(of(d, "path points").onlyA, ElementsAre(23));
  EXPECT_THAT(of(d, "views").changed, IsEmpty());
  EXPECT_DOUBLE_EQ(d.movedMost, 0.5);
  EXPECT_THAT(d.parameters, ElementsAre("+ [place]", "+ spacing = 0.9"));
  const Difference back = diff(b, a);
  EXPECT_THAT(of(back, "edges").onlyB, ElementsAre(2));
  EXPECT_THAT(back.parameters, ElementsAre("- [place]", "- spacing = 0.9"));
}

}  // namespace
}  // namespace engram::keeper

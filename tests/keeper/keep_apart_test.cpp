// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/closures.h"
#include "engram/pipeline/pipeline.h"
#include "tiny_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace engram::keeper {
namespace {

using Pair = std::pair<map::PlaceId, map::PlaceId>;

/// The closures of a map of the first drive, and how many images were refused because of a keeper.
std::vector<Pair> closuresOf(const std::vector<Pair>& apart, int& refused) {
  pipeline::Pipeline mapper(engram::testing::tinyParams());
  mapper.keepApart(apart);
  refused = 0;
  for (const auto& frame : engram::testing::firstDrive().frames)
    refused += mapper.process(frame).reason.find("keeper") != std::string::npos;
  std::vector<Pair> pairs;
  for (const auto& [id, edge] : mapper.map().edges())
    if (edge.type == map::EdgeType::kLoop) pairs.emplace_back(std::minmax(edge.a, edge.b));
  return pairs;
}

TEST(KeepApart, MappingHeedsWhatAKeeperHasRejected) {
  int refused = 0;
  const std::vector<Pair> closures = closuresOf({}, refused);
  ASSERT_FALSE(closures.empty());
  EXPECT_EQ(refused, 0);
  const std::vector<Pair> left = closuresOf(closures, refused);
  for (const Pair& pair : left) EXPECT_EQ(std::count(closures.begin(), closures.end(), pair), 0);
  EXPECT_LT(left.size(), closures.size());
}

TEST(KeepApart, RejectionsOutliveTheNote) {
  store::WholeMap map;
  const Rejections rejections = {{map::PlaceId(1), map::PlaceId(7)}, {map::PlaceId(0), map::PlaceId(12)}};
  setRejections(map, rejections);
  EXPECT_EQ(map.notes.at(kRejectedNote), "0 12\n1 7\n");
  EXPECT_EQ(rejectionsOf(map.notes), rejections);
  setRejections(map, {});
  EXPECT_TRUE(map.notes.empty());
}

}  // namespace
}  // namespace engram::keeper

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/joined_path.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace engram::map {
namespace {

/// So many places in a row, joined by odometry but for a weak edge before those in `breaks`.
TopologicalMap chain(int n, const std::vector<int>& breaks) {
  TopologicalMap map;
  for (int i = 0; i < n; ++i) {
    const PlaceId made = map.addPlace({});
    if (i == 0) continue;
    const bool weak = std::find(breaks.begin(), breaks.end(), i) != breaks.end();
    map.addEdge(
        {.type = weak ? EdgeType::kWeak : EdgeType::kOdometry, .a = PlaceId(made.value - 1), .b = made});
  }
  return map;
}

std::vector<PathPoint> pathOver(const std::vector<std::uint32_t>& places) {
  std::vector<PathPoint> path;
  for (const auto place : places) path.push_back({1, static_cast<double>(path.size()), PlaceId(place)});
  return path;
}

std::vector<double> stampsOf(const JoinedPath& joined) {
  std::vector<double> stamps;
  for (const auto& point : joined.points) stamps.push_back(point.stamp);
  return stamps;
}

TEST(JoinedPath, OfOnePartIsThePath) {
  const JoinedPath joined = joinedPath(chain(4, {}), pathOver({0, 1, 2, 3}));
  EXPECT_EQ(stampsOf(joined), (std::vector<double>{0, 1, 2, 3}));
  EXPECT_EQ(joined.apart, 0);
}

TEST(JoinedPath, LeavesOutWhatHangsOnAWeakLink) {
  const JoinedPath joined = joinedPath(chain(6, {2, 5}), pathOver({0, 1, 2, 3, 4, 5, 3, 0}));
  EXPECT_EQ(stampsOf(joined), (std::vector<double>{2, 3, 4, 6}));
  EXPECT_DOUBLE_EQ(joined.apart, 0.5);
}

TEST(JoinedPath, CountsPointsNotPlaces) {
  const JoinedPath joined = joinedPath(chain(6, {1}), pathOver({0, 0, 0, 0, 1, 2, 3}));
  EXPECT_EQ(stampsOf(joined), (std::vector<double>{0, 1, 2, 3}));
}

TEST(JoinedPath, OfEquallyLongOnesTheEarliestCounts) {
  EXPECT_EQ(stampsOf(joinedPath(chain(4, {2}), pathOver({3, 0, 2, 1}))), (std::vector<double>{0, 2}));
  EXPECT_TRUE(joinedPath(chain(2, {}), {}).points.empty());
}

TEST(JoinedPath, PlacesThatAreGoneAreLeftOut) {
  const JoinedPath joined = joinedPath(chain(3, {}), pathOver({0, 7, 1}));
  EXPECT_EQ(stampsOf(joined), (std::vector<double>{0, 2}));
  EXPECT_EQ(joined.apart, 0);
}

}  // namespace
}  // namespace engram::map

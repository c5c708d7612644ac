// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/evaluation/place_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace engram::evaluation {
namespace {

using Eigen::Vector3d;

/// Places 1 m apart along x, joined in order; the robot drives along them at 1 m/s from t = 0.
SurveyedPlaces line(int n) {
  SurveyedPlaces places;
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < n; ++i) {
    places.positions.emplace_back(i, 0, 0);
    if (i > 0) edges.emplace_back(i - 1, i);
  }
  places.adjacency = belief::Adjacency::fromEdges(static_cast<std::size_t>(n), edges);
  return places;
}

Truth drive(int margin = 0, double radius = 0.1) {
  TruthOptions options;
  options.margin = margin;
  options.radius = radius;
  options.maxGap = 100;
  return Truth::parse("0 0 0 0 0 0 0 1\n20 20 0 0 0 0 0 1\n", "gt", options);
}

TEST(PlaceError, CountsHopsMetresAndPartsOfPlaces) {
  const auto error = placeError(drive(), 6.3, line(12), 5, 5.2);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->truePlace, 6);
  EXPECT_NEAR(error->truePeak, 6.3, 1e-9);
  EXPECT_EQ(error->hops, 1);
  EXPECT_NEAR(error->places, 1.1, 1e-9);
  EXPECT_NEAR(error->metres, 1.3, 1e-9);
  EXPECT_EQ(error->verdict, Verdict::kRight);
}

TEST(PlaceError, IsRightWithinOneHopAndTheMarginOrWithinTheRadius) {
  const auto places = line(12);
  for (int place = 0; place < 12; ++place) {
    const int hops = std::abs(place - 6);
    const auto verdict = [&](const Truth& truth) {
      return placeError(truth, 6.0, places, place, place)->verdict;
    };
    EXPECT_EQ(verdict(drive()), hops <= 1 ? Verdict::kRight : Verdict::kWrong) << place;
    EXPECT_EQ(verdict(drive(2)), hops <= 3 ? Verdict::kRight : Verdict::kWrong) << place;
    EXPECT_EQ(verdict(drive(0, 2.5)), hops <= 2 ? Verdict::kRight : Verdict::kWrong) << place;
  }
}

TEST(PlaceError, CountsHopsOverALoopEdge) {
  auto places = line(10);
  std::vector<std::pair<int, int>> edges{{0, 9}};
  for (int i = 1; i < 10; ++i) edges.emplace_back(i - 1, i);
  places.adjacency = belief::Adjacency::fromEdges(10, edges);
  const auto error = placeError(drive(), 0.0, places, 9, 9.0);
  EXPECT_EQ(error->hops, 1);
  EXPECT_EQ(error->places, 1.0);
  EXPECT_EQ(error->verdict, Verdict::kRight);
}

TEST(PlaceError, OfAnUnreachablePlaceIsInfinite) {
  auto places = line(6);
  const std::vector<std::pair<int, int>> edges{{0, 1}, {1, 2}, {3, 4}, {4, 5}};
  places.adjacency = belief::Adjacency::fromEdges(6, edges);
  const auto error = placeError(drive(), 5.0, places, 0, 0.0);
  EXPECT_EQ(error->hops, -1);
  EXPECT_TRUE(std::isinf(error->places));
  EXPECT_EQ(error->verdict, Verdict::kWrong);
}

TEST(PlaceError, HasNothingToSayWithoutTruthOrPlaces) {
  EXPECT_FALSE(placeError(drive(), 30.0, line(3), 0, 0));
  EXPECT_FALSE(placeError(drive(), 1.0, line(0), 0, 0));
  EXPECT_THROW(placeError(drive(), 1.0, line(3), 3, 3), std::invalid_argument);
  auto wrong = line(3);
  wrong.positions.pop_back();
  EXPECT_THROW(placeError(drive(), 1.0, wrong, 0, 0), std::invalid_argument);
}

TEST(ChainPosition, ProjectsOnTheSegmentsBesideThePlace) {
  const auto places = line(5);
  EXPECT_NEAR(chainPosition(places, 2, Vector3d(2.4, 3, 0)), 2.4, 1e-12);
  EXPECT_NEAR(chainPosition(places, 2, Vector3d(1.7, -1, 0)), 1.7, 1e-12);
  EXPECT_NEAR(chainPosition(places, 0, Vector3d(-3, 0, 0)), 0.0, 1e-12) << "the chain ends there";
  SurveyedPlaces lonely;
  lonely.positions = {Vector3d(1, 1, 1)};
  lonely.adjacency = belief::Adjacency::fromEdges(1, {});
  EXPECT_EQ(chainPosition(lonely, 0, Vector3d::Zero()), 0.0);
}

}  // namespace
}  // namespace engram::evaluation

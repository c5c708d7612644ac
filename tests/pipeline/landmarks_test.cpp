// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Features of a place as landmarks, against points whose position is known.
#include "engram/pipeline/landmarks.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace engram::pipeline {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d planar(double x, double y, double heading) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(heading, Vector3d::UnitZ()).toRotationMatrix();
  T.translation() << x, y, 0;
  return T;
}

/// A place in the middle of a room 6 m wide, and a view of the same points from elsewhere in it.
struct Room {
  std::vector<Vector3d> points;  // seen from the place
  types::Features place, view;
  std::vector<types::Match> matches;
  Isometry3d T_place_view;
};

Room room(const Isometry3d& T_place_view, double noise, int count = 200) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), height(-1, 1);
  std::normal_distribution<double> off(0, noise);
  const auto ray = [&](const Vector3d& p) {
    const Vector3d b = p.normalized();
    return Vector3d(b + Vector3d(off(random), off(random), off(random))).normalized().cast<float>().eval();
  };
  Room r;
  r.T_place_view = T_place_view;
  for (int i = 0; i < count; ++i) {
    const double a = angle(random);
    const double reach = 3 / std::max(std::abs(std::cos(a)), std::abs(std::sin(a)));  // the walls
    r.points.emplace_back(reach * std::cos(a), reach * std::sin(a), height(random));
    r.place.keypoints.emplace_back();
    r.place.bearings.push_back(ray(r.points.back()));
    r.place.ranges.push_back(static_cast<float>(r.points.back().norm()));
    r.view.keypoints.emplace_back();
    r.view.bearings.push_back(ray(T_place_view.inverse() * r.points.back()));
    r.matches.push_back({.a = i, .b = i, .distance = 0});
  }
  return r;
}

TEST(Landmarks, TwoRaysMeetInThePoint) {
  const Room r = room(planar(0.5, -0.3, 0.7), 0);
  const auto found = triangulated(r.view, r.place, r.matches, r.T_place_view, 0.05);
  ASSERT_GT(found.size(), r.points.size() / 2);
  for (const Landmark& l : found) {
    const Vector3d& point = r.points[static_cast<std::size_t>(l.match.b)];
    EXPECT_NEAR(l.fromPlace, point.norm(), 1e-3);
    EXPECT_NEAR(l.fromView, (r.T_place_view.inverse() * point).norm(), 1e-3);
  }
}

TEST(Landmarks, RaysThatAreNearlyParallelOrMeetBehindTellNothing) {
  EXPECT_TRUE(triangulated(room(planar(0, 0, 0.4), 0).view, room(planar(0, 0, 0.4), 0).place,
                           room(planar(0, 0, 0.4), 0).matches, planar(0.01, 0, 0.4), 0.05)
                  .empty());
  const Room r = room(planar(0.5, 0, 0), 0);
  EXPECT_TRUE(triangulated(r.view, r.place, r.matches, planar(-0.5, 0, 0), 0.05).empty());
}

TEST(Landmarks, KnownRangesGiveTheLengthOfTheWay) {
  for (const double metres : {0.3, 1.0, 2.5}) {
    Room r = room(planar(metres * std::cos(0.4), metres * std::sin(0.4), 1.2), 0.004);
    std::mt19937 random(7);
    std::normal_distribution<double> off(0, 0.1);
    for (float& range : r.place.ranges) range *= static_cast<float>(std::max(0.5, 1 + off(random)));
    for (std::size_t i = 0; i < r.place.ranges.size(); i += 5) r.place.ranges[i] = 0;      // unknown
    for (std::size_t i = 1; i < r.place.ranges.size(); i += 7) r.place.ranges[i] *= 2.5f;  // wrong
    const auto length = lengthOf(r.view, r.place, r.matches, r.T_place_view.linear(),
                                 r.T_place_view.translation().normalized());
    ASSERT_TRUE(length) << metres;
    EXPECT_NEAR(length->metres, metres, 2 * length->sigma);
    EXPECT_LT(length->sigma, 0.15 * metres + 0.05);
  }
}

TEST(Landmarks, TooFewRangesOrAPlaceWithoutParallaxGiveNoLength) {
  Room r = room(planar(1, 0, 0), 0.004, 100);
  const Vector3d direction = Vector3d::UnitX();
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  EXPECT_FALSE(lengthOf(r.view, r.place, r.matches, R, Vector3d::Zero()));
  EXPECT_FALSE(lengthOf(r.view, r.place, r.matches, R, -direction)) << "it would be negative";
  std::fill(r.place.ranges.begin() + 5, r.place.ranges.end(), 0.0f);
  EXPECT_FALSE(lengthOf(r.view, r.place, r.matches, R, direction));
  r.place.ranges.clear();
  EXPECT_FALSE(lengthOf(r.view, r.place, r.matches, R, direction));
}

/// Bearings that are turned alone are off by the parallax; those that are moved by what is seen beside them
/// are off by much less, also where the feature itself has no match.
TEST(Landmarks, AViewIsMovedToWhereThePlaceIs) {
  const Room r = room(planar(0.4, 0.2, 0.9), 0.002);
  std::vector<types::Match> half;
  for (std::size_t i = 0; i < r.matches.size(); i += 2) half.push_back(r.matches[i]);
  const types::Features turned = inPlaceFrame(r.view, r.T_place_view.linear());
  const types::Features moved = inPlaceFrame(r.view, r.T_place_view, r.place, half);
  double offTurned = 0, offMoved = 0;
  for (std::size_t i = 1; i < r.points.size(); i += 2) {
    const Eigen::Vector3f truth = r.points[i].normalized().cast<float>();
    offTurned += std::acos(std::min(1.0f, turned.bearings[i].dot(truth)));
    offMoved += std::acos(std::min(1.0f, moved.bearings[i].dot(truth)));
  }
  EXPECT_LT(offMoved, 0.3 * offTurned);
}

TEST(Landmarks, WithoutMatchesAViewIsTurnedAlone) {
  const Room r = room(planar(0.4, 0.2, 0.9), 0);
  const types::Features turned = inPlaceFrame(r.view, r.T_place_view.linear());
  const types::Features moved = inPlaceFrame(r.view, r.T_place_view, r.place, {});
  for (std::size_t i = 0; i < r.points.size(); ++i)
    EXPECT_LT((turned.bearings[i] - moved.bearings[i]).norm(), 1e-6f);
}

}  // namespace
}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "whereabouts.h"

#include <gtest/gtest.h>

namespace engram::pipeline {
namespace {

constexpr base::PlaceId p(std::uint32_t v) { return base::PlaceId(v); }

Eigen::Isometry3d at(double x) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = x;
  return T;
}

const types::Matrix6d kCov = types::Matrix6d::Identity() * 1e-6;

/// At a place that it made after a metre on its wheels.
Whereabouts atFirstPlace(bool wheels = true) {
  Whereabouts robot({}, wheels, true);
  robot.turn(at(0), 0);
  robot.turn(at(1), 1);
  robot.made(p(0), 1, kCov);
  return robot;
}

TEST(Whereabouts, NothingIsMeasuredBeforeThereIsAPlace) {
  Whereabouts robot({}, true, true);
  robot.turn(at(0), 0);
  robot.turn(at(1), 1);
  EXPECT_FALSE(robot.metric());
  EXPECT_FALSE(robot.anchor().valid());
}

TEST(Whereabouts, EyesCountBeforeWheelsAndWheelsWhereEyesFail) {
  Whereabouts robot = atFirstPlace();
  robot.resume();
  robot.turn(at(3), 3);  // the wheels slip
  robot.see({.T_a_b = at(1.5), .cov = kCov}, 2, true);
  EXPECT_NEAR(robot.motion()->T_a_b.translation().x(), 1.5, 1e-12);
  robot.lose();
  EXPECT_NEAR(robot.motion()->T_a_b.translation().x(), 2, 1e-12);
  EXPECT_NEAR(robot.lastSeen().T_a_b.translation().x(), 1.5, 1e-12);
}

TEST(Whereabouts, WithoutWheelsALostRobotKnowsNothing) {
  Whereabouts robot = atFirstPlace(false);
  robot.turn(at(3), 3);
  EXPECT_FALSE(robot.metric());
}

TEST(Whereabouts, ADeniedClosureLeavesItWhereItsWheelsSay) {
  Whereabouts robot = atFirstPlace();
  robot.turn(at(3), 3);
  robot.restOn(base::EdgeId(7));
  robot.backAt(p(5), {.T_a_b = at(0.2), .cov = kCov});
  EXPECT_FALSE(robot.frontier());
  robot.turn(at(4), 4);
  EXPECT_NEAR(robot.motion()->T_a_b.translation().x(), 1.2, 1e-12);
  robot.deny({base::EdgeId(6)});
  EXPECT_EQ(robot.anchor(), p(5));
  robot.deny({base::EdgeId(6), base::EdgeId(7)});
  EXPECT_EQ(robot.anchor(), p(0));
  EXPECT_NEAR(robot.motion()->T_a_b.translation().x(), 3, 1e-12);
  EXPECT_TRUE(robot.frontier());
}

TEST(Whereabouts, CountsPlacesThatAgreeInARow) {
  Whereabouts robot = atFirstPlace();
  for (int i = 1; i <= 3; ++i) {
    robot.backAt(p(1), {.cov = kCov}, i > 1);
    EXPECT_EQ(robot.agreeing(), i);
  }
  robot.backAt(p(9), {.cov = kCov}, false);
  EXPECT_EQ(robot.agreeing(), 1);
  robot.restart();
  EXPECT_EQ(robot.agreeing(), 0);
  EXPECT_FALSE(robot.metric());
}

TEST(Whereabouts, AfterARestartTheWayIsUnknownOnce) {
  Whereabouts robot = atFirstPlace();
  robot.markKeyframe();
  robot.turn(at(2), 2);
  robot.restart();
  EXPECT_FALSE(robot.markKeyframe());
  robot.turn(at(3), 3);
  ASSERT_TRUE(robot.markKeyframe());
}

TEST(Whereabouts, AfterALeapTheWayIsUnknownUntilThereIsAnAnchor) {
  Whereabouts robot = atFirstPlace();
  robot.markKeyframe();
  EXPECT_TRUE(robot.turn(at(2), 2));
  EXPECT_FALSE(robot.turn(at(500), 3));
  EXPECT_TRUE(robot.turn(at(501), 4));
  EXPECT_TRUE(robot.strayed());
  EXPECT_FALSE(robot.metric());
  EXPECT_FALSE(robot.markKeyframe());
  robot.backAt(p(0), {.T_a_b = at(0), .cov = kCov});
  EXPECT_FALSE(robot.strayed());
  EXPECT_TRUE(robot.turn(at(502), 5));
  EXPECT_NEAR(robot.motion()->T_a_b.translation().x(), 1, 1e-12);
  EXPECT_TRUE(robot.markKeyframe());
}

TEST(Whereabouts, RecentPlacesAreThoseNearTheNewest) {
  map::TopologicalMap map;
  Whereabouts robot({}, true, true);
  for (std::uint32_t i = 0; i < 6; ++i) {
    map.addPlace({});
    if (i > 0) map.addEdge({.a = p(i - 1), .b = p(i), .T_a_b = {.T_a_b = at(1), .cov = kCov}});
    robot.made(p(i), i, kCov);
    robot.keepRecent(map, 2);
  }
  EXPECT_EQ(robot.recent(), (std::set<base::PlaceId>{p(3), p(4), p(5)}));
  robot.backAt(p(0), {.cov = kCov});
  EXPECT_TRUE(robot.recent().empty());
}

}  // namespace
}  // namespace engram::pipeline

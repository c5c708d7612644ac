// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace engram::world {
namespace {

const Route& officeRoute() {
  static const Route route(presetPlan("office", 1));
  return route;
}

TEST(Route, IsAClosedCurveOfArcLength) {
  const Route& r = officeRoute();
  EXPECT_NEAR(r.length(), 80, 6);
  EXPECT_NEAR(r.pitch(), 1.0, 0.02);
  for (double s = 0; s < r.length(); s += 0.37) {
    const Pose2 a = r.at(s), b = r.at(s + 0.1), c = r.at(s + r.length());
    EXPECT_NEAR(std::hypot(b.x - a.x, b.y - a.y), 0.1, 0.003) << s;
    EXPECT_NEAR(a.x, c.x, 1e-6);
    EXPECT_NEAR(
        std::remainder(std::atan2(b.y - a.y, b.x - a.x) - r.at(s + 0.05).heading, 2 * std::numbers::pi), 0,
        0.1)
        << s;
  }
  EXPECT_EQ(r.stationAt(0.4), 0);
  EXPECT_EQ(r.stationAt(-0.4), 0);
  EXPECT_EQ(r.stationAt(0.6 * r.pitch()), 1);
  EXPECT_EQ(r.stationAt(-0.6 * r.pitch()), r.stations() - 1);
}

TEST(Drive, KeepsToFreeSpaceAndTakesImagesAtTheSpacing) {
  const Plan plan = presetPlan("office", 1);
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const DriveKind kind : {DriveKind::kTour, DriveKind::kTest}) {
      const Drive d(officeRoute(), {}, kind, seed);
      Pose2 last = d.poseAt(0);
      for (double t = 0; t < d.duration(); t += 0.05) {
        const Pose2 p = d.poseAt(t);
        const char c = plan.at(static_cast<int>(p.x / plan.cell), static_cast<int>(p.y / plan.cell));
        ASSERT_TRUE(isFloor(c) || c == '+') << "seed " << seed << " at " << p.x << "," << p.y;
        ASSERT_LT(std::hypot(p.x - last.x, p.y - last.y), 0.08) << "no jumps, t " << t;
        last = p;
      }
      if (kind == DriveKind::kTest) continue;
      for (std::size_t i = 1; i < d.imageTimes().size(); ++i) {
        const Pose2 a = d.poseAt(d.imageTimes()[i - 1]), b = d.poseAt(d.imageTimes()[i]);
        ASSERT_LT(std::hypot(b.x - a.x, b.y - a.y), 0.53);
      }
      EXPECT_NEAR(static_cast<double>(d.imageTimes().size()), officeRoute().length() / 0.5, 8);
    }
}

// One drive without a stop: the first round is the same, the second one goes on from it, at other offsets.
TEST(Drive, GoesRoundSeveralTimes) {
  DriveParams p;
  const Drive once(officeRoute(), p, DriveKind::kTour, 1);
  p.laps = 2;
  const Drive twice(officeRoute(), p, DriveKind::kTour, 1);
  const double end = once.duration();
  for (double t = 0; t < end - 2; t += 3.1) {
    EXPECT_EQ(twice.poseAt(t).x, once.poseAt(t).x);
    EXPECT_EQ(twice.poseAt(t).y, once.poseAt(t).y);
  }
  EXPECT_NEAR(twice.arcLengthAt(twice.duration()), 2 * officeRoute().length(), 0.1);
  Pose2 last = twice.poseAt(end - 3);
  double apart = 0, step = 0;
  for (double t = end - 3; t < end + 3; t += 0.05) {
    const Pose2 now = twice.poseAt(t);
    step = std::max(step, std::hypot(now.x - last.x, now.y - last.y));
    last = now;
  }
  EXPECT_LT(step, 0.05);  // no jump at the seam
  for (double t = end; t < twice.duration(); t += 0.5) {
    const double s = twice.arcLengthAt(t);
    apart = std::max(apart, std::abs(between(officeRoute().at(s), twice.poseAt(t)).y));
  }
  EXPECT_GT(apart, 0.05);
  EXPECT_LT(apart, 0.6);
}

TEST(Drive, DiffersBetweenSeedsAndTheTestDriveIsElsewhere) {
  const Drive a(officeRoute(), {}, DriveKind::kTour, 1), b(officeRoute(), {}, DriveKind::kTour, 2);
  const Drive again(officeRoute(), {}, DriveKind::kTour, 1), test(officeRoute(), {}, DriveKind::kTest, 1);
  EXPECT_EQ(a.poseAt(30).x, again.poseAt(30).x);
  const auto aside = [](const Drive& d, double t) {
    const Pose2 p = between(officeRoute().at(d.arcLengthAt(t)), d.poseAt(t));
    return std::abs(p.y);
  };
  double tour = 0, other = 0, apart = 0;
  int forward = 0, backward = 0;
  for (double t = 1; t < 100; t += 0.5) {
    tour += aside(a, t), other += aside(test, t);
    apart += std::abs(aside(a, t) - aside(b, t)) / 198;
  }
  for (double t = 0; t + 1 < test.duration(); t += 0.5) {
    const double ds = test.arcLengthAt(t + 0.5) - test.arcLengthAt(t);
    forward += ds > 0.02, backward += ds < -0.02;
  }
  EXPECT_GT(apart, 0.03);
  EXPECT_GT(other, 1.5 * tour);
  EXPECT_GT(backward, forward / 4);
  EXPECT_GT(forward, backward);
}

// Monte Carlo: the error of a stretch has the variance that the parameters promise.
TEST(Drive, OdometryNoiseIsAsConfigured) {
  DriveParams p;
  p.odometry_distance = 0.03, p.odometry_lateral = 0, p.odometry_heading = 0.02, p.odometry_turn = 0.05,
  p.odometry_scale = 0;
  p.lateral = 0, p.heading = 0;
  constexpr int n = 200;
  const Route route(presetPlan("tiny", 1));
  double along2 = 0, heading2 = 0, headingMean = 0, length = 0, turned = 0;
  for (int i = 0; i < n; ++i) {
    const Drive d(route, p, DriveKind::kTour, 100 + static_cast<std::uint64_t>(i));
    const double t0 = 3.0, t1 = 6.0;  // a straight of 2 m or so
    const Pose2 truth = between(d.poseAt(t0), d.poseAt(t1));
    const Pose2 odo = between(d.odometryAt(t0), d.odometryAt(t1));
    along2 += std::pow(odo.x - truth.x, 2);
    length = std::hypot(truth.x, truth.y);
    double driven = 0;
    turned = 0;
    const auto& ticks = d.odometry();
    for (std::size_t k = 1; k < ticks.size(); ++k) {
      const Pose2 step = between(d.poseAt(ticks[k - 1].t), d.poseAt(ticks[k].t));
      driven += std::hypot(step.x, step.y), turned += std::abs(step.heading);
    }
    const double error =
        std::remainder(ticks.back().pose.heading - (d.poseAt(d.duration()).heading - d.poseAt(0).heading),
                       2 * std::numbers::pi);
    heading2 += error * error / (0.02 * 0.02 * driven + 0.05 * 0.05 * turned);
    headingMean += error / n;
  }
  ASSERT_GT(length, 1.0);
  // The variance of a sample variance of n normal numbers is 2/n: 4 sigma of the ratio is 0.4.
  EXPECT_NEAR(along2 / n / (0.03 * 0.03 * length), 1, 0.4);
  EXPECT_NEAR(heading2 / n, 1, 0.4);
  EXPECT_NEAR(headingMean, 0, 0.04);
  EXPECT_NEAR(turned, 2 * std::numbers::pi, 0.6);
}

TEST(Drive, PerfectWheelsReturnToTheStart) {
  DriveParams p;
  p.odometry_distance = p.odometry_lateral = p.odometry_heading = p.odometry_turn = p.odometry_scale = 0;
  const Drive d(officeRoute(), p, DriveKind::kTour, 3);
  for (double t = 0; t < d.duration(); t += 1.7) {
    const Pose2 truth = between(d.poseAt(0), d.poseAt(t)), odo = d.odometryAt(t);
    EXPECT_NEAR(odo.x, truth.x, 0.004);  // interpolation between the readings
    EXPECT_NEAR(odo.y, truth.y, 0.004);
  }
}

}  // namespace
}  // namespace engram::world

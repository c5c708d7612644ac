// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/types/pose2.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::types {
namespace {

void expectNear(const Pose2& a, const Pose2& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(std::remainder(a.heading - b.heading, 2 * M_PI), 0.0, tolerance);
}

TEST(Pose2, BetweenUndoesCompose) {
  base::Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Pose2 a{rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-3, 3)};
    const Pose2 b{rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-3, 3)};
    expectNear(between(a, compose(a, b)), b);
    EXPECT_TRUE(toIsometry(compose(a, b)).isApprox(toIsometry(a) * toIsometry(b), 1e-12));
    expectNear(toPose2(toIsometry(a)), a);
  }
}

// A robot that drives a circle of radius r around the origin: x = r cos, y = r sin, heading tangential.
TEST(Interpolate, StaysOnTheCircle) {
  const double r = 2.5;
  const auto onCircle = [r](double angle) {
    return Pose2{r * std::cos(angle), r * std::sin(angle), std::remainder(angle + M_PI / 2, 2 * M_PI)};
  };
  for (const double from : {0.0, 1.0, 2.9})
    for (const double turn : {1e-7, 1e-4, 0.5, -1.0, 2.5})
      for (const double s : {0.0, 0.25, 0.5, 0.9, 1.0}) {
        Pose2 a = onCircle(from), b = onCircle(from + turn);
        expectNear(interpolate(a, b, s), onCircle(from + s * turn), 1e-9);
      }
}

TEST(Interpolate, StraightLineAndTurnOnTheSpot) {
  expectNear(interpolate({1, 2, 0.3}, {3, 6, 0.3}, 0.25), {1.5, 3, 0.3});
  expectNear(interpolate({1, 2, 3.0}, {1, 2, -3.0}, 0.5), {1, 2, M_PI});  // the short way round
}

}  // namespace
}  // namespace engram::types

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
// F eq (1) against the geometry it stands for.
#include "conic.h"

#include "scene.h"

#include <gtest/gtest.h>

namespace engram::geometry {
namespace {

using namespace testing_scene;

class Conic : public testing::TestWithParam<double> {};

TEST_P(Conic, HoldsForEveryPointOfThePlane) {
  const double xi = GetParam();
  base::Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d n = randomUnit(rng);
    const Eigen::Vector3d ray = n.cross(randomUnit(rng)).normalized();
    if (ray.z() < 0.1 - std::min(1.0, xi)) continue;
    const Eigen::Vector3d v = toNormalisedPlane(ray, xi);
    EXPECT_NEAR(v.dot(epipolarConic(n, xi) * v) / v.squaredNorm(), 0, 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Mirrors, Conic, testing::Values(0.0, 0.8, 0.97, 1.0, 1.4));

class ConicOfMirror : public testing::TestWithParam<double> {};

TEST_P(ConicOfMirror, HasASecondBranchThatIsNotInThePlane) {  // F-E17
  const double xi = GetParam();
  const double lowest = -std::min(xi, 1 / xi);
  base::Rng rng(2);
  int outside = 0, tried = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d n = randomUnit(rng);
    const Eigen::Vector3d hidden = n.cross(randomUnit(rng)).normalized();
    if (hidden.z() > lowest - 0.01) continue;
    // The line through (0, 0, -xi) and this ray, which the camera cannot see, meets the sphere in one that it
    // sees.
    const Eigen::Vector3d centre(0, 0, -xi), direction = hidden - centre;
    const Eigen::Vector3d seen = centre + (xi * xi - 1) / direction.squaredNorm() * direction;
    ASSERT_NEAR(seen.norm(), 1, 1e-9);
    ASSERT_GT(seen.z(), lowest);
    const Eigen::Vector3d v = toNormalisedPlane(seen, xi);
    EXPECT_NEAR(v.dot(epipolarConic(n, xi) * v) / v.squaredNorm(), 0, 1e-10);
    ++tried;
    outside += std::abs(n.dot(seen)) > 0.02;
  }
  EXPECT_GT(outside, 0.9 * tried);
  EXPECT_GT(tried, 50);
}

INSTANTIATE_TEST_SUITE_P(Mirrors, ConicOfMirror, testing::Values(0.8, 0.97, 1.4));

TEST(ConicDistance, IsTheDistanceForSmallOffsets) {
  const double xi = 0.97;
  base::Rng rng(3);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d n = randomUnit(rng);
    const Eigen::Vector3d ray = n.cross(randomUnit(rng)).normalized();
    if (ray.z() < -0.5) continue;
    const Eigen::Vector3d v = toNormalisedPlane(ray, xi);
    const Eigen::Matrix3d C = epipolarConic(n, xi);
    const Eigen::Vector2d normal = (C * v).head<2>().normalized();
    const Eigen::Vector3d moved = v + 1e-5 * Eigen::Vector3d(normal.x(), normal.y(), 0);
    EXPECT_NEAR(conicDistance(C, moved), 1e-5, 1e-7);
    EXPECT_NEAR(conicDistance(7 * C, moved), conicDistance(C, moved), 1e-15);
  }
}

}  // namespace
}  // namespace engram::geometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/visual_scan.h"

#include "engram/base/rng.h"
#include "stereo_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace engram::odometry {
namespace {

using geometry::testing_scene::kModel;

/// Unit descriptors, one direction a point, with noise.
types::Features featuresAt(const std::vector<types::StereoPoint>& points, bool right, base::Rng& rng) {
  types::Features out;
  out.descriptors = types::Descriptors(types::DescriptorKind::kFloat, 64);
  base::Rng directions(99);
  for (const auto& p : points) {
    Eigen::Matrix<float, 64, 1> d;
    for (int k = 0; k < 64; ++k) d[k] = static_cast<float>(directions.normal());
    d.normalize();
    for (int k = 0; k < 64; ++k) d[k] += static_cast<float>(rng.normal(0, 0.02));
    d.normalize();
    std::vector<std::byte> row(sizeof d);
    std::memcpy(row.data(), d.data(), sizeof d);
    out.descriptors.append(row);
    out.keypoints.push_back({.x = static_cast<float>(right ? p.u - p.disparity : p.u),
                             .y = static_cast<float>(p.v),
                             .angle = 0.1f});
  }
  return out;
}

std::vector<types::StereoPoint> somePoints(int n, base::Rng& rng) {
  std::vector<types::StereoPoint> points;
  for (int i = 0; i < n; ++i) points.push_back(kModel.project(geometry::testing_scene::pointInView(rng)));
  return points;
}

TEST(MakeScan, FindsRangesInTheSameRow) {
  base::Rng rng(1);
  const auto points = somePoints(80, rng);
  const auto left = featuresAt(points, false, rng), right = featuresAt(points, true, rng);
  const auto scan = makeScan(left, right, kModel);
  ASSERT_EQ(scan.size(), 80U);
  ASSERT_EQ(scan.ranges.size(), 80U);
  for (std::size_t i = 0; i < 80; ++i)
    EXPECT_NEAR(scan.ranges[i], kModel.toPoint(points[i]).norm(), 1e-2 * scan.ranges[i]);
}

TEST(MakeScan, RowTurnAndDescriptorMustAgree) {
  base::Rng rng(2);
  const auto points = somePoints(4, rng);
  const auto left = featuresAt(points, false, rng);
  auto right = featuresAt(points, true, rng);
  right.keypoints[0].y += 3;                        // another row
  right.keypoints[1].angle += 0.5f;                 // 29 degrees
  right.keypoints[2].x = left.keypoints[2].x + 20;  // a negative disparity
  const auto scan = makeScan(left, right, kModel);
  ASSERT_EQ(scan.size(), 1U);
  EXPECT_EQ(scan.keypoints[0].x, left.keypoints[3].x);
  right.keypoints[1].angle = left.keypoints[1].angle - 0.3f + static_cast<float>(2 * M_PI);  // 17 degrees
  EXPECT_EQ(makeScan(left, right, kModel).size(), 2U);
  EXPECT_EQ(makeScan(left, right, kModel, {.max_rows = 4}).size(), 3U);
  EXPECT_EQ(makeScan(left, right, kModel, {.max_distance = 1e-3}).size(), 0U);
}

TEST(MatchScans, LooksWhereThePointsAreExpected) {
  base::Rng rng(3);
  const auto scene = geometry::testing_scene::makeStereoScene({.points = 100, .distance = 0.3}, rng);
  std::vector<types::StereoPoint> inA, inB;
  for (const auto& m : scene.matches) {
    inA.push_back(m.a);
    inB.push_back(m.b);
  }
  const auto ranged = [&](types::Features f, const std::vector<types::StereoPoint>& points) {
    for (const auto& p : points) f.ranges.push_back(types::rangeOf(p, kModel));
    return f;
  };
  auto a = ranged(featuresAt(inA, false, rng), inA);
  const auto b = ranged(featuresAt(inB, false, rng), inB);
  const auto matches = matchScans(a, b, scene.T_a_b, kModel);
  EXPECT_GE(matches.size(), 99U);
  for (const auto& m : matches) EXPECT_EQ(m.a, m.b);
  // Half a window aside nothing is found.
  Eigen::Isometry3d wrong = scene.T_a_b;
  wrong.linear() = wrong.linear() * Eigen::AngleAxisd(0.12, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_LT(matchScans(a, b, wrong, kModel).size(), 20U);
  a.ranges[7] = 0;
  for (const auto& m : matchScans(a, b, scene.T_a_b, kModel)) EXPECT_NE(m.a, 7);
  types::Features other = b;
  other.descriptors = types::quantised(b.descriptors);
  EXPECT_THROW(matchScans(a, other, scene.T_a_b, kModel), std::invalid_argument);
  types::Features small = a;
  small.descriptors = types::quantised(a.descriptors);
  EXPECT_GE(matchScans(small, other, scene.T_a_b, kModel).size(), 97U);
}

}  // namespace
}  // namespace engram::odometry

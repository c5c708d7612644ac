// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
// Models against closed forms and against OpenCV.
#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/unified_sphere.h"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/ccalib/omnidir.hpp>

#include <cmath>
#include <numbers>

namespace engram::cameras::camera_truth {
namespace {

constexpr ImagePlaneParams kPlane{.fx = 150,
                                  .fy = 148,
                                  .cx = 321.3,
                                  .cy = 238.1,
                                  .skew = 0.7,
                                  .k1 = -0.12,
                                  .k2 = 0.02,
                                  .p1 = 1e-3,
                                  .p2 = -2e-3};
constexpr ImagePlaneParams kPlain{.fx = 150, .fy = 150, .cx = 320, .cy = 240};
const cv::Size kSize(640, 480);

Eigen::Vector3d atAngle(double fromAxis, double around = 0.3) {
  return {std::sin(fromAxis) * std::cos(around), std::sin(fromAxis) * std::sin(around), std::cos(fromAxis)};
}

TEST(UnifiedSphere, AgreesWithOpenCv) {
  base::Rng rng(3);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 500; ++i) points.emplace_back(rng.normal(), rng.normal(), 0.4 + std::abs(rng.normal()));
  const cv::Matx33d K(kPlane.fx, kPlane.skew, kPlane.cx, 0, kPlane.fy, kPlane.cy, 0, 0, 1);
  const cv::Vec4d D(kPlane.k1, kPlane.k2, kPlane.p1, kPlane.p2);
  for (const double xi : {0.0, 0.8, 1.0, 1.7}) {
    std::vector<cv::Point2d> pixels;
    cv::omnidir::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), K, xi, D);
    const UnifiedSphere camera(kSize, xi, kPlane);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto pixel = camera.project({points[i].x, points[i].y, points[i].z});
      if (!pixel) continue;  // beyond the fold of the distortion, which OpenCV does not know
      EXPECT_NEAR(pixel->x(), pixels[i].x, 1e-9);
      EXPECT_NEAR(pixel->y(), pixels[i].y, 1e-9);
    }
  }
}

TEST(UnifiedSphere, WithoutMirrorIsThePinhole) {
  const UnifiedSphere sphere(kSize, 0, kPlane);
  const Pinhole pinhole(kSize, kPlane);
  for (double angle = 0; angle < 1.5; angle += 0.05) {
    const auto a = sphere.project(atAngle(angle)), b = pinhole.project(atAngle(angle));
    ASSERT_EQ(a.has_value(), b.has_value()) << angle;
    if (a) {
      EXPECT_LT((*a - *b).norm(), 1e-9);
    }
  }
}

TEST(UnifiedSphere, ParabolicMirrorIsStereographic) {
  const UnifiedSphere camera(kSize, 1, kPlain);
  for (double angle = 0; angle < 3.0; angle += 0.1) {
    const auto pixel = camera.project(5 * atAngle(angle));
    ASSERT_TRUE(pixel);
    EXPECT_NEAR((*pixel - Eigen::Vector2d(320, 240)).norm(), 150 * std::tan(angle / 2), 1e-9);
  }
}

TEST(UnifiedSphere, SeesAsFarAsTheModelIsOneToOne) {
  for (const double xi : {0.0, 0.5, 0.97, 1.0, 1.3, 3.0}) {
    const UnifiedSphere camera(kSize, xi, kPlain);
    const double limit = std::acos(-std::min(xi, xi > 0 ? 1 / xi : 0.0));
    EXPECT_TRUE(camera.project(atAngle(limit - 1e-3))) << xi;
    EXPECT_EQ(camera.project(atAngle(limit + 1e-4)).has_value(), xi == 1) << xi;  // xi = 1 lacks -z only
    EXPECT_FALSE(camera.project({0, 0, -1})) << xi;
  }
}

TEST(UnifiedSphere, WideFisheyeHasAnEdgeInTheImage) {
  const double xi = 2;
  const UnifiedSphere camera(kSize, xi, kPlain);
  const double edge = 150 / std::sqrt(xi * xi - 1);
  EXPECT_TRUE(camera.unproject({320 + edge - 0.01, 240}));
  EXPECT_FALSE(camera.unproject({320 + edge + 0.01, 240}));
}

TEST(UnifiedSphere, RefusesImpossibleParameters) {
  EXPECT_THROW(UnifiedSphere(kSize, -0.1, kPlain), base::Error);
  EXPECT_THROW(UnifiedSphere(kSize, std::nan(""), kPlain), base::Error);
  EXPECT_THROW(UnifiedSphere(cv::Size(0, 480), 1, kPlain), base::Error);
  EXPECT_THROW(UnifiedSphere(kSize, 1, ImagePlaneParams{.fx = 0}), base::Error);
}

TEST(Pinhole, AgreesWithOpenCv) {
  const ImagePlaneParams plane{.fx = 420,
                               .fy = 415,
                               .cx = 318,
                               .cy = 243,
                               .k1 = -0.3,
                               .k2 = 0.09,
                               .k3 = -0.01,
                               .p1 = 5e-4,
                               .p2 = -8e-4};
  const Pinhole camera(kSize, plane);
  const cv::Matx33d K(plane.fx, 0, plane.cx, 0, plane.fy, plane.cy, 0, 0, 1);
  const cv::Vec<double, 5> D(plane.k1, plane.k2, plane.p1, plane.p2, plane.k3);
  base::Rng rng(4);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 500; ++i)
    points.emplace_back(rng.uniform(-1, 1), rng.uniform(-0.7, 0.7), rng.uniform(1.3, 3));
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, D, pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = camera.project({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(pixel->y(), pixels[i].y, 1e-9);
  }
}

TEST(Pinhole, DistortionEndsWhereItFoldsBack) {
  const Pinhole camera(kSize, ImagePlaneParams{.fx = 200, .fy = 200, .cx = 320, .cy = 240, .k1 = -0.3});
  const double fold = std::sqrt(1 / 0.9);  // d/dr (r - 0.3 r^3) = 0
  EXPECT_TRUE(camera.project({fold - 1e-3, 0, 1}));
  EXPECT_FALSE(camera.project({fold + 1e-3, 0, 1}));
  const double edge = 200 * fold * (1 - 0.3 * fold * fold);
  EXPECT_TRUE(camera.unproject({320 + edge - 0.01, 240}));
  EXPECT_FALSE(camera.unproject({320 + edge + 0.01, 240}));
}

TEST(Pinhole, DoesNotSeeBehindItself) {
  const Pinhole camera(kSize, kPlain);
  EXPECT_FALSE(camera.project({1, 1, 0}));
  EXPECT_FALSE(camera.project({0, 0, -1}));
}

TEST(Pinhole, FieldOfViewSpansTheImageBorders) {
  const auto camera = approximatePinhole(kSize, std::numbers::pi / 2);
  const auto left = camera->unproject({-0.5, 239.5}), right = camera->unproject({639.5, 239.5});
  ASSERT_TRUE(left && right);
  EXPECT_NEAR(std::acos(left->dot(*right)), std::numbers::pi / 2, 1e-12);
  EXPECT_THROW(approximatePinhole(kSize, 0), base::Error);
  EXPECT_THROW(approximatePinhole(kSize, std::numbers::pi), base::Error);
}

TEST(Equirectangular, AxesAreWhereTheHeaderSays) {
  const Equirectangular camera({2048, 1024});
  const auto at = [&](double x, double y, double z) { return camera.project({x, y, z}).value(); };
  EXPECT_LT((at(0, 0, 2) - Eigen::Vector2d(1023.5, 511.5)).norm(), 1e-9);
  EXPECT_LT((at(3, 0, 0) - Eigen::Vector2d(1023.5 + 512, 511.5)).norm(), 1e-9);
  EXPECT_LT((at(-3, 0, 0) - Eigen::Vector2d(1023.5 - 512, 511.5)).norm(), 1e-9);
  EXPECT_LT((at(0, 1, 1) - Eigen::Vector2d(1023.5, 511.5 + 256)).norm(), 1e-9);
  EXPECT_FALSE(camera.project({0, 1, 0}));
  EXPECT_FALSE(camera.unproject({10, -0.6}));
  const auto left = camera.unproject({-0.5, 300}), right = camera.unproject({2047.5, 300});
  ASSERT_TRUE(left && right);
  EXPECT_LT((*left - *right).norm(), 1e-12);
}

}  // namespace
}  // namespace engram::cameras::camera_truth

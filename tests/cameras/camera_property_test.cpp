// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
// The laws that hold for every camera model.
#include "engram/base/rng.h"
#include "engram/cameras/camera_rig.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/unified_sphere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace engram::cameras {
namespace {

constexpr ImagePlaneParams kPlain{.fx = 150, .fy = 148, .cx = 321.3, .cy = 238.1};
constexpr ImagePlaneParams kDistorted{.fx = 150,
                                      .fy = 148,
                                      .cx = 321.3,
                                      .cy = 238.1,
                                      .skew = 0.7,
                                      .k1 = -0.12,
                                      .k2 = 0.02,
                                      .p1 = 1e-3,
                                      .p2 = -2e-3};
constexpr ImagePlaneParams kLens{
    .fx = 420, .fy = 415, .cx = 318, .cy = 243, .k1 = -0.3, .k2 = 0.09, .k3 = -0.01, .p1 = 5e-4, .p2 = -8e-4};
const cv::Size kSize(640, 480);

struct Case {
  std::string name;
  std::shared_ptr<const Camera> camera;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Case sphere(const std::string& name, double xi, const ImagePlaneParams& plane) {
  return {name, std::make_shared<UnifiedSphere>(kSize, xi, plane)};
}

std::vector<Case> cases() {
  ImagePlaneParams mirrored = kDistorted;
  mirrored.fx = -mirrored.fx;
  return {sphere("xi_0", 0, kPlain),
          sphere("xi_0_8", 0.8, kPlain),
          sphere("xi_1", 1, kPlain),
          sphere("xi_1_6", 1.6, kPlain),
          sphere("xi_0_97_distorted", 0.97, kDistorted),
          sphere("xi_1_distorted", 1, kDistorted),
          sphere("xi_2_5_distorted", 2.5, kDistorted),
          sphere("mirrored", 0.97, mirrored),
          {"pinhole", std::make_shared<Pinhole>(kSize, kPlain)},
          {"pinhole_distorted", std::make_shared<Pinhole>(kSize, kLens)},
          {"approximate_pinhole", approximatePinhole(kSize, 1.2)},
          {"equirectangular", std::make_shared<Equirectangular>(cv::Size(640, 320))}};
}

class CameraLaw : public testing::TestWithParam<Case> {
 protected:
  const Camera& camera() const { return *GetParam().camera; }
  Eigen::Vector2d randomPixel() {
    const cv::Size s = camera().imageSize();
    return {rng_.uniform(0, s.width - 1.0), rng_.uniform(0, s.height - 1.0)};
  }
  Eigen::Vector3d randomPoint() { return {rng_.normal(), rng_.normal(), rng_.normal()}; }
  base::Rng rng_{7};
};

TEST_P(CameraLaw, PixelToRayToPixelIsIdentity) {
  int seen = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector2d pixel = randomPixel();
    const auto ray = camera().unproject(pixel);
    if (!ray) continue;
    ++seen;
    ASSERT_NEAR(ray->norm(), 1, 1e-12);
    const auto back = camera().project(*ray * rng_.uniform(0.01, 100));
    ASSERT_TRUE(back) << pixel.transpose();
    ASSERT_LT((*back - pixel).norm(), 1e-6) << pixel.transpose();
  }
  EXPECT_GT(seen, 100);
}

TEST_P(CameraLaw, RayToPixelToRayIsIdentity) {
  int seen = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d point = randomPoint();
    const auto pixel = camera().project(point);
    if (!pixel) continue;
    ++seen;
    ASSERT_TRUE(pixel->allFinite());
    const auto ray = camera().unproject(*pixel);
    ASSERT_TRUE(ray) << point.transpose();
    ASSERT_LT((*ray - point.normalized()).norm(), 1e-6) << point.transpose();
  }
  EXPECT_GT(seen, 200);
}

TEST_P(CameraLaw, ProjectionJacobianIsTheDerivative) {
  const double h = 1e-6;
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d point = randomPoint();
    Matrix23d J, numeric;
    const auto pixel = camera().project(point, &J);
    const cv::Size s = camera().imageSize();
    if (!pixel || !cv::Rect2d(0, 0, s.width, s.height).contains({pixel->x(), pixel->y()})) continue;
    bool complete = true;
    for (int k = 0; k < 3 && complete; ++k) {
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
      const auto plus = camera().project(point + step), minus = camera().project(point - step);
      complete = plus && minus && (*plus - *minus).norm() < 10;  // not across the seam of a panorama
      if (complete) numeric.col(k) = (*plus - *minus) / (2 * h);
    }
    if (!complete) continue;
    ++compared;
    ASSERT_LT((J - numeric).norm(), 1e-5 * (1 + J.norm())) << point.transpose();
    ASSERT_LT((J * point).norm(), 1e-8 * (1 + J.norm()) * point.norm());  // depth does not move a pixel
  }
  EXPECT_GT(compared, 50);
}

TEST_P(CameraLaw, UnprojectionJacobianIsTheDerivative) {
  const double h = 1e-4;
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d pixel = randomPixel();
    Matrix32d J, numeric;
    const auto ray = camera().unproject(pixel, &J);
    if (!ray) continue;
    bool complete = true;
    for (int k = 0; k < 2 && complete; ++k) {
      const Eigen::Vector2d step = h * Eigen::Vector2d::Unit(k);
      const auto plus = camera().unproject(pixel + step), minus = camera().unproject(pixel - step);
      complete = plus && minus;
      if (complete) numeric.col(k) = (*plus - *minus) / (2 * h);
    }
    if (!complete) continue;
    ++compared;
    ASSERT_LT((J - numeric).norm(), 1e-6 * (1e-3 + J.norm()) + 1e-9) << pixel.transpose();
    ASSERT_LT((ray->transpose() * J).norm(), 1e-9);  // a unit ray turns, it does not stretch
  }
  EXPECT_GT(compared, 30);
}

TEST_P(CameraLaw, BadInputIsNotVisible) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera().project(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(camera().project({nan, 0, 1}));
  EXPECT_FALSE(camera().unproject({nan, 0}));
  EXPECT_FALSE(camera().unproject({0, std::numeric_limits<double>::infinity()}));
}

TEST_P(CameraLaw, TextReproducesTheCamera) {
  const std::string text = camera().toText();
  const auto again = parseCamera(text, "text").camera;
  EXPECT_EQ(again->toText(), text);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point = randomPoint();
    const auto a = camera().project(point), b = again->project(point);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      ASSERT_EQ(*a, *b);
    }
  }
}

TEST_P(CameraLaw, ScalingMovesPixelsAroundTheImageCorner) {
  const auto half = camera().scaled(0.5, 0.25);
  EXPECT_EQ(half->imageSize(), cv::Size(camera().imageSize().width / 2, camera().imageSize().height / 4));
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point = randomPoint();
    const auto full = camera().project(point), small = half->project(point);
    ASSERT_EQ(full.has_value(), small.has_value());
    if (!full) continue;
    const Eigen::Vector2d expected((full->x() + 0.5) * 0.5 - 0.5, (full->y() + 0.5) * 0.25 - 0.5);
    ASSERT_LT((*small - expected).norm(), 1e-9 * (1 + expected.norm()));
  }
}

INSTANTIATE_TEST_SUITE_P(AllModels, CameraLaw, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace engram::cameras

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/lifting_table.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/unified_sphere.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace engram::cameras::lifting {
namespace {

const std::string kShare = std::string(ENGRAM_SOURCE_DIR) + "/share/cameras/";

/// Largest angle between table and model over random image points [rad]; a pixel is about 1/fx.
double worstError(const CameraRig& rig, int& compared) {
  const LiftingTable table(rig);
  base::Rng rng(5);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const float x = static_cast<float>(rng.uniform(-0.5, rig.camera->imageSize().width - 0.5));
    const float y = static_cast<float>(rng.uniform(-0.5, rig.camera->imageSize().height - 0.5));
    const auto exact = rig.camera->unproject({x, y});
    const auto looked = table.bearing(x, y);
    EXPECT_EQ(exact.has_value(), looked.has_value()) << x << " " << y;
    if (!exact || !looked) continue;
    ++compared;
    worst = std::max(worst, exact->cross(looked->cast<double>()).norm());
    EXPECT_NEAR(looked->norm(), 1, 1e-6);
  }
  return worst;
}

TEST(LiftingTable, AgreesWithTheModelToAThousandthOfAPixel) {
  for (const char* file : {"omni_world.ini", "pinhole_world.ini", "equirectangular_2048.ini"}) {
    const CameraRig rig = loadCamera(kShare + file);
    int compared = 0;
    EXPECT_LT(worstError(rig, compared), 1e-5) << file;
    EXPECT_EQ(compared, 20000) << file;
  }
}

TEST(LiftingTable, ExactOnPixelsAndOutsideTheImage) {
  const CameraRig rig = loadCamera(kShare + "omni_world.ini");
  const LiftingTable table(rig);
  for (const auto& [x, y] : {std::pair{100.f, 200.f}, {0.f, 0.f}, {639.f, 479.f}, {-3.25f, 600.f}})
    EXPECT_LT((table.bearing(x, y).value() - rig.camera->unproject({x, y})->cast<float>()).norm(), 1e-7);
}

TEST(LiftingTable, BlankWhereTheModelSeesNothing) {
  const ImagePlaneParams plane{.fx = 150, .fy = 150, .cx = 320, .cy = 240};
  CameraRig rig = makeRig(std::make_shared<UnifiedSphere>(cv::Size(640, 480), 2.0, plane));
  rig.mask(cv::Rect(0, 230, 640, 20)) = 0;
  int compared = 0;
  EXPECT_LT(worstError(rig, compared), 0.02);  // the ray turns ever faster towards the edge of the fisheye
  EXPECT_LT(compared, 10000);
  const LiftingTable table(rig);
  const std::vector<types::Keypoint> keypoints{{.x = 320, .y = 200}, {.x = 5, .y = 5}};
  const auto bearings = table.bearings(keypoints);
  ASSERT_EQ(bearings.size(), 2u);
  EXPECT_NEAR(bearings[0].norm(), 1, 1e-6);
  EXPECT_TRUE(bearings[1].isZero(0));
  EXPECT_EQ(table.imageMask().at<std::uint8_t>(5, 5), 0);      // no ray
  EXPECT_EQ(table.imageMask().at<std::uint8_t>(240, 320), 0);  // masked by the rig
  EXPECT_EQ(table.imageMask().at<std::uint8_t>(200, 320), 255);
}

TEST(LiftingTable, RefusesAMaskOfAnotherSize) {
  CameraRig rig = makeRig(std::make_shared<Equirectangular>(cv::Size(64, 32)));
  rig.mask = cv::Mat(5, 5, CV_8U, cv::Scalar(255));
  EXPECT_THROW(LiftingTable{rig}, base::Error);
}

TEST(ErodedMask, KeepsWhatIsFartherThanTheRadius) {
  cv::Mat mask(60, 60, CV_8U, cv::Scalar(255));
  mask.at<std::uint8_t>(30, 30) = 0;
  const cv::Mat eroded = erodedMask(mask, 6);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const double distance = std::hypot(x - 30, y - 30);
      if (distance > 5 && distance <= 7) continue;  // the disc is not exact to a pixel
      EXPECT_EQ(eroded.at<std::uint8_t>(y, x), distance > 7 ? 255 : 0) << x << " " << y;
    }
  EXPECT_EQ(cv::norm(erodedMask(mask, 0), mask, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace engram::cameras::lifting

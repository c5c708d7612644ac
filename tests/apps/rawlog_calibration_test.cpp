// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "board_scene.h"
#include "calibration.h"
#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/unified_sphere.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>

namespace engram::apps {
namespace {

using testing_board::boardPose;
using testing_board::kBoard;
using testing_board::kSquare;
const cv::Size kSize(640, 480);

cameras::ImagePlaneParams omniPlane() {
  cameras::ImagePlaneParams plane;
  plane.fx = 192, plane.fy = 194, plane.cx = 315, plane.cy = 236;
  plane.k1 = -0.06, plane.k2 = 0.01, plane.p1 = 0.001, plane.p2 = -0.002;
  return plane;
}

std::shared_ptr<const cameras::Camera> omni() {
  return std::make_shared<cameras::UnifiedSphere>(kSize, 0.95, omniPlane());
}

std::vector<BoardView> project(const cameras::Camera& camera, double noise, int views,
                               double maxPolar = 1.2) {
  base::Rng rng(5);
  std::vector<BoardView> result;
  for (int i = 0; static_cast<int>(result.size()) < views; ++i) {
    const auto T = boardPose(2.4 * i, maxPolar * std::sqrt(rng.uniform()), rng.uniform(0.22, 0.35), rng);
    BoardView view{"view " + std::to_string(i), {}};
    for (int row = 0; row < kBoard.height; ++row)
      for (int column = 0; column < kBoard.width; ++column) {
        const auto pixel = camera.project(T * Eigen::Vector3d(column * kSquare, row * kSquare, 0));
        if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > 639 || pixel->y() > 479) continue;
        view.corners.emplace_back(static_cast<float>(pixel->x() + rng.normal(0, noise)),
                                  static_cast<float>(pixel->y() + rng.normal(0, noise)));
      }
    if (view.corners.size() == static_cast<std::size_t>(kBoard.area())) result.push_back(view);
  }
  return result;
}

/// Largest angle between the rays that two cameras give the pixels of the inner image [deg].
double rayDifference(const cameras::Camera& a, const cameras::Camera& b) {
  double worst = 0.0;
  for (int y = 60; y < 420; y += 20)
    for (int x = 140; x < 500; x += 20) {
      const auto p = a.unproject(Eigen::Vector2d(x, y)), q = b.unproject(Eigen::Vector2d(x, y));
      if (!p || !q) return 180.0;
      worst = std::max(worst, std::atan2(p->cross(*q).norm(), p->dot(*q)) * 180.0 / std::numbers::pi);
    }
  return worst;
}

TEST(Calibrate, UnifiedRecoversTheRays) {
  const auto truth = omni();
  const auto result = calibrate(project(*truth, 0.1, 16), kSize, {true, kBoard, kSquare, false});
  EXPECT_NEAR(result.rms, 0.1 * std::sqrt(2.0), 0.03);  // of the distance: two coordinates
  EXPECT_LT(rayDifference(*result.camera, *truth), 0.3);
  EXPECT_EQ(result.camera->model(), "unified_sphere");
}

TEST(Calibrate, PinholeRecoversTheRays) {
  cameras::ImagePlaneParams plane;
  plane.fx = 400, plane.fy = 402, plane.cx = 322, plane.cy = 238, plane.k1 = -0.2, plane.k2 = 0.05;
  const cameras::Pinhole truth(kSize, plane);
  const auto result = calibrate(project(truth, 0.1, 16, 0.4), kSize, {false, kBoard, kSquare, false});
  EXPECT_NEAR(result.rms, 0.1 * std::sqrt(2.0), 0.03);
  EXPECT_LT(rayDifference(*result.camera, truth), 0.2);
}

TEST(Calibrate, ViewWithWrongCornersIsLeftOut) {
  auto views = project(*omni(), 0.1, 14);
  for (std::size_t i = 0; i < views[4].corners.size(); ++i)
    views[4].corners[i].x += static_cast<float>(6.0 * std::sin(static_cast<double>(i)));
  const auto result = calibrate(views, kSize, {true, kBoard, kSquare, false});
  EXPECT_FALSE(result.views[4].used);
  EXPECT_TRUE(result.views[5].used);
  EXPECT_LT(result.rms, 0.2);
}

// Seen in a mirror, a board looks like a board: the detector counts its columns from the other side.
TEST(Calibrate, MirroredCameraHasMirroredRays) {
  auto plane = omniPlane();
  plane.fx = -plane.fx;
  const cameras::UnifiedSphere truth(kSize, 0.95, plane);
  auto views = project(truth, 0.0, 16);
  for (auto& view : views)
    for (int row = 0; row < kBoard.height; ++row)
      std::reverse(view.corners.begin() + row * kBoard.width,
                   view.corners.begin() + (row + 1) * kBoard.width);
  const auto result = calibrate(views, kSize, {true, kBoard, kSquare, true});
  EXPECT_LT(result.rms, 1e-3);
  EXPECT_LT(rayDifference(*result.camera, truth), 0.05);
  const auto plain = calibrate(views, kSize, {true, kBoard, kSquare, false});
  EXPECT_GT(rayDifference(*plain.camera, truth), 30.0);
}

TEST(Calibrate, TooFewViewsIsAnError) {
  EXPECT_THROW(calibrate(project(*omni(), 0.1, 2), kSize, {true, kBoard, kSquare, false}), base::Error);
}

TEST(FindBoard, CornersOfABentBoardToAFractionOfAPixel) {
  const auto camera = omni();
  base::Rng rng(3);
  for (const double polar : {0.3, 0.8}) {
    const auto T = boardPose(1.0, polar, 0.2, rng);
    const auto corners = findBoard(testing_board::render(*camera, T), kBoard);
    ASSERT_TRUE(corners) << polar;
    double sum = 0.0;
    for (int row = 0; row < kBoard.height; ++row)
      for (int column = 0; column < kBoard.width; ++column) {
        const auto truth = camera->project(T * Eigen::Vector3d(column * kSquare, row * kSquare, 0));
        double nearest = 1e9;  // the detector may count from the other end
        for (const auto& c : *corners)
          nearest = std::min(nearest, std::hypot(c.x - truth->x(), c.y - truth->y()));
        sum += nearest * nearest;
      }
    EXPECT_LT(std::sqrt(sum / kBoard.area()), 0.15) << polar;
  }
  EXPECT_FALSE(findBoard(cv::Mat(kSize, CV_8U, cv::Scalar(90)), kBoard));
}

TEST(FindBoard, RealOmnidirectionalImages) {
  const char* given = std::getenv("ENGRAM_DATASETS");
  const std::string folder =
      (given ? std::string(given) : std::string(ENGRAM_SOURCE_DIR) + "/../shared/datasets") + "/omni_calib/";
  if (!std::filesystem::exists(folder)) {
    if (std::getenv("CI")) FAIL() << folder << " is missing: set ENGRAM_DATASETS";
    GTEST_SKIP() << "NOT TESTED on real images: " << folder << " is missing: set ENGRAM_DATASETS";
  }
  std::vector<BoardView> views;
  cv::Size size;
  for (const int i : {1, 3, 4, 8, 10, 12, 13, 16}) {
    const cv::Mat image = cv::imread(folder + std::to_string(i) + ".jpg");
    size = image.size();
    auto corners = findBoard(image, kBoard);
    ASSERT_TRUE(corners) << i;
    views.push_back({std::to_string(i), *corners});
  }
  const auto result = calibrate(views, size, {true, kBoard, kSquare, false});
  EXPECT_LT(result.rms, 0.6);
}

}  // namespace
}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/pinhole.h"
#include "reprojector.h"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <numbers>

namespace engram::apps {
namespace {

using std::numbers::pi;

cameras::CameraRig panorama(cv::Size size) {
  return cameras::makeRig(std::make_shared<cameras::Equirectangular>(size));
}

cameras::CameraRig worldOmni() {
  return cameras::loadCamera(std::string(ENGRAM_SOURCE_DIR) + "/share/cameras/omni_world.ini");
}

/// A smooth brightness for each direction in the robot's frame, different in all of them.
double brightness(const Eigen::Vector3d& d) {
  return 128.0 + 60.0 * std::sin(2.0 * d.x() + 0.5) * std::cos(1.5 * d.y()) +
         40.0 * std::sin(2.5 * d.z() + d.y());
}

cv::Mat paint(const cameras::CameraRig& rig, double heading) {
  const cv::Size size = rig.camera->imageSize();
  cv::Mat image(size, CV_8U, cv::Scalar(0));
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix() * rig.T_robot_cam.linear();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (const auto ray = rig.camera->unproject(Eigen::Vector2d(x, y));
          ray && rig.mask.at<std::uint8_t>(y, x) != 0)
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(brightness(R * *ray));
  return image;
}

TEST(Reprojector, ShowsEveryDirectionWhereTheCameraModelPutsIt) {
  const auto from = panorama({512, 256});
  const auto to = worldOmni();
  const Reprojector reproject(from, to);
  const cv::Mat source = paint(from, 0.0);
  // The seam of the panorama lies behind; every heading moves it elsewhere in the image.
  for (const double heading : {0.0, 0.4, pi / 2, 3.0, -2.0}) {
    const cv::Mat image = reproject(source, heading);
    ASSERT_EQ(image.size(), cv::Size(640, 480));
    EXPECT_LE(cv::norm(image, paint(to, heading), cv::NORM_INF), 3.0) << heading;
  }
}

// A left turn by h brings what was at azimuth h to the front.
TEST(Reprojector, HeadingTurnsLeft) {
  const auto from = panorama({512, 256});
  cv::Mat source(256, 512, CV_8U, cv::Scalar(0));
  const auto ahead = cameras::makeRig(cameras::approximatePinhole({101, 101}, pi / 3));
  // A bright spot 90 degrees to the left of the robot: a quarter of the width left of the middle.
  source(cv::Rect(127 - 4, 127 - 4, 10, 10)) = cv::Scalar(255);
  const Reprojector reproject(from, ahead);
  EXPECT_EQ(cv::countNonZero(reproject(source, 0.0)), 0);
  const cv::Mat turned = reproject(source, pi / 2);
  EXPECT_EQ(turned.at<std::uint8_t>(50, 50), 255);
}

TEST(Reprojector, ColourAndPinholeSources) {
  const auto from = cameras::makeRig(cameras::approximatePinhole({320, 240}, pi / 2));
  const auto to = cameras::makeRig(cameras::approximatePinhole({160, 120}, pi / 3));
  const cv::Mat grey = paint(from, 0.0);
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{grey, cv::Mat::zeros(grey.size(), CV_8U), grey}, colour);
  const cv::Mat image = Reprojector(from, to)(colour, 0.0);
  std::vector<cv::Mat> channels;
  cv::split(image, channels);
  EXPECT_LE(cv::norm(channels[0], paint(to, 0.0), cv::NORM_INF), 3.0);
  EXPECT_EQ(cv::countNonZero(channels[1]), 0);
}

// Stripes much finer than the wanted pixels must melt into grey, not alias into coarse ones.
TEST(Reprojector, FineDetailIsAveraged) {
  const auto from = panorama({2048, 1024});
  const auto to = cameras::makeRig(cameras::approximatePinhole({120, 90}, pi / 2));
  cv::Mat stripes(1024, 2048, CV_8U);
  for (int x = 0; x < 2048; ++x) stripes.col(x).setTo(x % 2 == 0 ? 0 : 255);
  const Reprojector reproject(from, to);
  EXPECT_GE(reproject.oversampling(), 3);
  cv::Scalar mean, deviation;
  cv::meanStdDev(reproject(stripes, 0.1), mean, deviation);
  EXPECT_NEAR(mean[0], 127.5, 4.0);
  EXPECT_LT(deviation[0], 25.0);  // single samples would give 80 and more
}

TEST(Reprojector, WrongSizeIsAnError) {
  const Reprojector reproject(panorama({512, 256}), worldOmni());
  EXPECT_THROW(reproject(cv::Mat(100, 200, CV_8U), 0.0), base::Error);
}

}  // namespace
}  // namespace engram::apps

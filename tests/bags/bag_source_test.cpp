// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// The drive of tests/fixtures/bags/make_ros1.py, read back from what each writer made of it.
#include "engram/bags/bag_source.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"

#include <gmock/gmock.h>

#include <cmath>

namespace engram::bags {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kT0 = 1700000000;

std::string bagFile(const std::string& name) {
  return std::string(ENGRAM_SOURCE_DIR) + "/tests/fixtures/bags/" + name;
}

BagSourceParams stereoParams() {
  BagSourceParams params;
  params.image = "/stereo/left/image_raw";
  params.right = "/stereo/right/image_raw";
  return params;
}

/// Half a metre per second on a circle of 2.5 m.
Eigen::Isometry3d poseAt(double t) {
  Eigen::Isometry3d T(Eigen::AngleAxisd(0.2 * t, Eigen::Vector3d::UnitZ()));
  T.translation() << 2.5 * std::sin(0.2 * t), 2.5 * (1 - std::cos(0.2 * t)), 0;
  return T;
}

class BagSourceTest : public testing::TestWithParam<const char*> {};

TEST_P(BagSourceTest, PairsTheEyesByStamp) {
  const auto source = openBagSource(bagFile(GetParam()), stereoParams());
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_NEAR(frame->stamp, kT0 + 0.1 * i, 1e-6);
    ASSERT_EQ(frame->image.type(), CV_8UC3);
    ASSERT_EQ(frame->right.type(), CV_8UC1);
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 16; ++x) {
        ASSERT_EQ(frame->image.at<cv::Vec3b>(y, x), cv::Vec3b(9 * y, 5 * x, 10 + 20 * i));
        ASSERT_EQ(frame->right.at<std::uint8_t>(y, x), 3 * x + y + i);
      }
  }
  EXPECT_FALSE(source->next());
  EXPECT_EQ(source->problem(), "");
  EXPECT_EQ(source->imagesUnpaired(), 2u);  // the last ones are 40 ms apart
}

TEST_P(BagSourceTest, InterpolatesOdometry) {
  const auto source = openBagSource(bagFile(GetParam()), stereoParams());
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame && frame->T_odom_robot);
    EXPECT_TRUE(frame->T_odom_robot->isApprox(poseAt(0.1 * i), 1e-6)) << i;
  }
  auto params = stereoParams();
  params.odometry = "none";
  EXPECT_FALSE(openBagSource(bagFile(GetParam()), params)->next()->T_odom_robot);
}

TEST_P(BagSourceTest, KnowsCalibrationAndMount) {
  const auto source = openBagSource(bagFile(GetParam()), stereoParams());
  ASSERT_TRUE(source->stereo());
  const auto& left = source->stereo()->left;
  const auto plane = dynamic_cast<const cameras::Pinhole&>(*left.camera).plane();
  EXPECT_EQ(left.camera->imageSize(), cv::Size(16, 12));
  cameras::ImagePlaneParams expected;
  expected.fx = 15, expected.fy = 15.5, expected.cx = 7.5, expected.cy = 5.5;
  expected.k1 = -0.1, expected.k2 = 0.01, expected.p1 = 0.001, expected.p2 = -0.002;
  EXPECT_EQ(plane, expected);
  EXPECT_TRUE(source->stereo()->T_left_right().translation().isApprox(Eigen::Vector3d(0.12, 0, 0), 1e-9));
  // The camera looks forward on a plate that is turned by 0.1 rad.
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(left.T_robot_cam.translation().isApprox(Eigen::Vector3d(0.2, 0.05, 0.6), 1e-9));
  EXPECT_TRUE(left.T_robot_cam.linear().col(2).isApprox(turned.col(0), 1e-9));
  EXPECT_TRUE(left.T_robot_cam.linear().col(1).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9));
}

TEST_P(BagSourceTest, ReadsCompressedImages) {
  BagSourceParams params;
  params.image = "/top/image_raw/compressed";
  const auto source = openBagSource(bagFile(GetParam()), params);
  for (int i = 0; i < 4; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->image.type(), CV_8UC1);
    EXPECT_EQ(frame->image.at<std::uint8_t>(7, 9), 3 * 9 + 7 + i);
  }
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->camera());
  EXPECT_THAT(source->notes(), Contains(HasSubstr("/top/camera_info has no message")));
}

TEST_P(BagSourceTest, AsksWhereThereIsAChoice) {
  const auto messageOf = [](const BagSourceParams& params) -> std::string {
    try {
      openBagSource(bagFile(GetParam()), params);
    } catch (const base::Error& e) {
      return e.what();
    }
    return "";
  };
  BagSourceParams params;
  EXPECT_THAT(messageOf(params), AllOf(HasSubstr("--image"), HasSubstr("/top/image_raw/compressed"),
                                       HasSubstr("sensor_msgs/Image, 4 messages")));
  params.image = "/odom";
  EXPECT_THAT(messageOf(params), HasSubstr("no images of the topic '/odom'"));
  params = stereoParams();
  params.odometry = "/wheels";
  EXPECT_THAT(messageOf(params), HasSubstr("no odometry of '/wheels'"));
}

INSTANTIATE_TEST_SUITE_P(Writers, BagSourceTest,
                         testing::Values("ros1_none.bag", "ros1_bz2.bag", "ros1_lz4.bag", "ros2.db3",
                                         "ros2_none.mcap", "ros2_lz4.mcap", "ros2_zstd.mcap"));

}  // namespace
}  // namespace engram::bags

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
// Calibration files: what ships loads and means what it says; what is wrong is named.
#include "engram/cameras/camera_rig.h"

#include "engram/base/error.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/cameras/unified_sphere.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <fstream>
#include <numbers>

namespace engram::cameras {
namespace {

const std::string kShare = std::string(ENGRAM_SOURCE_DIR) + "/share/cameras/";
const std::string kOmni =
    "[camera]\nmodel = unified_sphere\nwidth = 64\nheight = 48\nxi = 0.97\nfx = 15\nfy = 15\ncx = 31.5\ncy = "
    "23.5\n";

std::string message(const std::string& text) {
  try {
    parseCamera(text, "cam.ini");
  } catch (const base::ConfigError& e) {
    return e.what();
  }
  return "no error";
}

double elevation(const CameraRig& rig, double x, double y) {
  const Eigen::Vector3d ray = rig.T_robot_cam.linear() * rig.camera->unproject({x, y}).value();
  return std::asin(ray.z()) * 180 / std::numbers::pi;
}

TEST(CameraFiles, AllShippedOnesRoundTripThroughTheirText) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kShare)) {
    if (entry.path().extension() != ".ini") continue;
    ++files;
    const CameraRig rig = loadCamera(entry.path().string());
    const CameraRig again = parseCamera(toText(rig), "text");
    EXPECT_EQ(toText(again), toText(rig)) << entry.path();
    EXPECT_TRUE(again.T_robot_cam.isApprox(rig.T_robot_cam, 1e-12)) << entry.path();
    EXPECT_EQ(cv::norm(again.mask, rig.mask, cv::NORM_INF), 0) << entry.path();
  }
  EXPECT_GE(files, 4);
}

TEST(CameraFiles, OmniWorldSeesAroundTheHorizon) {
  const CameraRig rig = loadCamera(kShare + "omni_world.ini");
  EXPECT_NEAR(elevation(rig, 319.5 + 45, 239.5), -55, 1);
  EXPECT_NEAR(elevation(rig, 319.5, 239.5 - 235), 25, 0.5);
  EXPECT_LT(elevation(rig, 319.5, 239.5), -89);
  // Forward is at the top of the image, left of the robot at its left.
  const auto forward = rig.camera->project(rig.T_robot_cam.linear().transpose() * Eigen::Vector3d(1, 0, 0));
  const auto left = rig.camera->project(rig.T_robot_cam.linear().transpose() * Eigen::Vector3d(0, 1, 0));
  ASSERT_TRUE(forward && left);
  EXPECT_NEAR(forward->x(), 319.5, 1e-6);
  EXPECT_NEAR(forward->y(), 239.5 - 146.3, 0.1);
  EXPECT_NEAR(left->x(), 319.5 - 146.3, 0.1);
  EXPECT_NEAR(left->y(), 239.5, 1e-6);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(239, 319), 0);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(239, 319 + 150), 255);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(2, 2), 0);
}

TEST(CameraFiles, StereoPairHasItsBaselineAlongX) {
  const auto [left, right] = loadStereoRig(kShare + "stereo_world.ini");
  const Eigen::Isometry3d T_left_right = left.T_robot_cam.inverse() * right.T_robot_cam;
  EXPECT_TRUE(T_left_right.translation().isApprox(Eigen::Vector3d(0.09, 0, 0), 1e-12));
  EXPECT_TRUE(T_left_right.linear().isIdentity(1e-12));
  EXPECT_NEAR(std::acos(left.camera->unproject({-0.5, 239.5})->dot(*left.camera->unproject({639.5, 239.5}))),
              std::numbers::pi / 2, 1e-12);
}

TEST(CameraFiles, DefaultMountsPointAsDocumented) {
  const Eigen::Matrix3d forward = defaultMount("pinhole").linear();
  EXPECT_EQ(Eigen::Vector3d(forward.col(2)), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(Eigen::Vector3d(forward.col(0)), Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(defaultMount("equirectangular").linear(), forward);
  const Eigen::Matrix3d down = defaultMount("unified_sphere").linear();
  EXPECT_EQ(Eigen::Vector3d(down.col(2)), Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(Eigen::Vector3d(down.col(1)), Eigen::Vector3d(-1, 0, 0));
  EXPECT_TRUE(parseCamera(kOmni, "t").T_robot_cam.linear().isApprox(down, 1e-12));
}

TEST(CameraFiles, MountFollowsMrptsYawPitchRoll) {
  const CameraRig rig = parseCamera(kOmni + "[mount]\nx=1\ny=2\nz=3\nyaw=30\npitch=-20\nroll=10\n", "t");
  const auto rad = [](double deg) { return deg * std::numbers::pi / 180; };
  // First column of Rz(yaw) Ry(pitch) Rx(roll): (cy cp, sy cp, -sp).
  const Eigen::Vector3d x(std::cos(rad(30)) * std::cos(rad(-20)), std::sin(rad(30)) * std::cos(rad(-20)),
                          -std::sin(rad(-20)));
  EXPECT_LT((rig.T_robot_cam.linear().col(0) - x).norm(), 1e-12);
  EXPECT_NEAR(rig.T_robot_cam.linear()(2, 1), std::cos(rad(-20)) * std::sin(rad(10)), 1e-12);
  EXPECT_EQ(Eigen::Vector3d(rig.T_robot_cam.translation()), Eigen::Vector3d(1, 2, 3));
  const CameraRig again = parseCamera(toText(rig), "t");
  EXPECT_TRUE(again.T_robot_cam.isApprox(rig.T_robot_cam, 1e-10));
}

TEST(CameraFiles, GimbalLockSurvivesTheText) {
  const CameraRig rig = parseCamera(kOmni + "[mount]\nyaw=30\npitch=90\nroll=-45\n", "t");
  EXPECT_TRUE(parseCamera(toText(rig), "t").T_robot_cam.isApprox(rig.T_robot_cam, 1e-9));
}

TEST(CameraFiles, PinholeNeedsAnAngleOrACalibration) {
  const CameraRig rig = parseCamera("[camera]\nmodel=pinhole\nwidth=100\nheight=50\nfov_deg=90\n", "t");
  const auto& camera = dynamic_cast<const Pinhole&>(*rig.camera);
  EXPECT_NEAR(camera.plane().fx, 50, 1e-12);
  EXPECT_NEAR(camera.plane().cx, 49.5, 1e-12);
  EXPECT_THAT(message("[camera]\nmodel=pinhole\nwidth=100\nheight=50\nfov_deg=90\nfx=3\n"),
              testing::HasSubstr("fx and fov_deg exclude each other"));
  EXPECT_THAT(message("[camera]\nmodel=pinhole\nwidth=100\nheight=50\n"),
              testing::HasSubstr("fx is missing"));
}

TEST(CameraFiles, MistakesAreNamed) {
  EXPECT_THAT(message(kOmni + "k9 = 1\n"),
              testing::AllOf(testing::HasSubstr("cam.ini:10"), testing::HasSubstr("k9")));
  EXPECT_THAT(message(kOmni + "fov_deg = 90\n"), testing::HasSubstr("fov_deg"));
  EXPECT_THAT(message("[mask]\n"), testing::HasSubstr("no section [camera]"));
  EXPECT_THAT(message("[camera]\nwidth=3\n"), testing::HasSubstr("model is missing"));
  EXPECT_THAT(message("[camera]\nmodel=fisheye\n"), testing::HasSubstr("'fisheye' is not one of"));
  EXPECT_THAT(message("[camera]\nmodel=unified_sphere\nwidth=64\nheight=48\nfx=1\nfy=1\ncx=1\ncy=1\n"),
              testing::HasSubstr("xi is missing"));
  EXPECT_THAT(message(kOmni + "[mask]\ninner_radius=20\nouter_radius=10\n"),
              testing::HasSubstr("smaller than"));
  EXPECT_THAT(message(kOmni + "[mask]\ninner_radius=500\n"), testing::HasSubstr("leaves no pixel"));
  EXPECT_THAT(message(kOmni + "[mask]\nfile=/nonexistent.png\n"), testing::HasSubstr("/nonexistent.png"));
  EXPECT_THAT(message(kOmni + "[mount]\nyaw=4000\n"), testing::HasSubstr("out of range"));
  std::string zero = kOmni;
  zero.replace(zero.find("fx = 15"), 7, "fx = 0 ");
  EXPECT_THAT(message(zero), testing::HasSubstr("must not be zero"));
  EXPECT_THROW(loadCamera("/nonexistent/cam.ini"), base::ConfigError);
}

/// A table of rays of 32768 x 32768 pixels took all memory, and for ever.
TEST(CameraFiles, ImagesOfImpossibleSizeAreRefused) {
  const auto sized = [](int width, int height) {
    std::string text = kOmni;
    text.replace(text.find("width = 64"), 10, "width = " + std::to_string(width));
    text.replace(text.find("height = 48"), 11, "height = " + std::to_string(height));
    return message(text);
  };
  EXPECT_THAT(sized(32768, 32768), testing::AllOf(testing::HasSubstr("cam.ini: [camera] "),
                                                  testing::HasSubstr("width x height = 32768x32768"),
                                                  testing::HasSubstr("67108864")));
  EXPECT_THAT(sized(32769, 4), testing::AllOf(testing::HasSubstr("[camera] width: 32769 is out of range"),
                                              testing::HasSubstr("32768]")));
}

class CameraFilesOnDisk : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("engram_cameras_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(CameraFilesOnDisk, AnyEditorMayHaveWrittenThem) {
  const std::string truth = toText(parseCamera(kOmni, "text"));
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text = "\xEF\xBB\xBF# mine\n" + kOmni;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size())
      text.replace(at, 1, end);
    const std::string path = (folder_ / "cam.ini").string();
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_EQ(toText(loadCamera(path)), truth);
    EXPECT_FALSE(describesStereo(path));
  }
  EXPECT_THROW(loadCamera(folder_.string()), base::ConfigError);
}

TEST_F(CameraFilesOnDisk, MaskImageTravelsWithTheFile) {
  cv::Mat image(48, 64, CV_8U, cv::Scalar(255));
  image(cv::Rect(0, 0, 10, 48)) = 0;
  cv::imwrite((folder_ / "m.png").string(), image);
  std::ofstream(folder_ / "a.ini") << kOmni << "[mask]\ninner_radius = 5\nfile = m.png\n";
  const CameraRig rig = loadCamera((folder_ / "a.ini").string());
  EXPECT_EQ(rig.mask.at<std::uint8_t>(20, 9), 0);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(20, 10), 255);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(23, 31), 0);
  saveCamera(rig, (folder_ / "b.ini").string());
  const CameraRig again = loadCamera((folder_ / "b.ini").string());
  EXPECT_EQ(cv::norm(again.mask, rig.mask, cv::NORM_INF), 0);
  EXPECT_EQ(again.camera->toText(), rig.camera->toText());
  EXPECT_THROW(saveCamera(rig, (folder_ / "missing" / "b.ini").string()), base::Error);
  cv::imwrite((folder_ / "m.png").string(), cv::Mat(5, 5, CV_8U, cv::Scalar(255)));
  EXPECT_THROW(loadCamera((folder_ / "a.ini").string()), base::ConfigError);
}

TEST_F(CameraFilesOnDisk, PanoramaLosesRowsAtTopAndBottom) {
  const CameraRig rig = loadCamera(kShare + "equirectangular_2048.ini");
  EXPECT_EQ(rig.mask.at<std::uint8_t>(127, 5), 0);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(128, 5), 255);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(767, 5), 255);
  EXPECT_EQ(rig.mask.at<std::uint8_t>(768, 5), 0);
}

}  // namespace
}  // namespace engram::cameras

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
// Calibrations of stereo cameras: both kinds of file, and what rectification makes of them.
#include "engram/cameras/stereo_rig.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/rectifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/img/TStereoCamera.h>
#include <opencv2/imgproc.hpp>

#include <functional>

namespace engram::cameras::stereo_rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kShare = std::string(ENGRAM_SOURCE_DIR) + "/share/cameras/";

/// A head as shops sell it: two lenses with distortion, not quite parallel.
StereoRig crooked() {
  ImagePlaneParams left{.fx = 458.7, .fy = 457.3, .cx = 367.2, .cy = 248.4};
  left.k1 = -0.283, left.k2 = 0.074, left.p1 = 2e-4, left.p2 = 1.8e-5;
  ImagePlaneParams right{.fx = 457.6, .fy = 456.1, .cx = 380, .cy = 255.2};
  right.k1 = -0.284, right.k2 = 0.0745, right.p1 = -1e-4, right.p2 = -3.6e-5;
  StereoRig rig{makeRig(std::make_shared<Pinhole>(cv::Size(752, 480), left)),
                makeRig(std::make_shared<Pinhole>(cv::Size(752, 480), right))};
  rig.left.T_robot_cam.translation() = Eigen::Vector3d(0.1, 0.055, 1.2);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(0.03, Eigen::Vector3d(0.3, 0.5, 1).normalized()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(0.11, -0.001, 0.002);
  rig.right.T_robot_cam = rig.left.T_robot_cam * T;
  return rig;
}

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const base::Error& e) {
    return e.what();
  }
  return "no error";
}

std::string message(const std::string& text) {
  return message([&] { parseStereoRig(text, "rig.ini"); });
}

TEST(StereoFiles, OwnTextRoundTrips) {
  for (const auto& rig : {crooked(), loadStereoRig(kShare + "stereo_world.ini")}) {
    const StereoRig again = parseStereoRig(toText(rig), "text");
    EXPECT_TRUE(again.left.T_robot_cam.isApprox(rig.left.T_robot_cam, 1e-12));
    EXPECT_TRUE(again.right.T_robot_cam.isApprox(rig.right.T_robot_cam, 1e-10));
    EXPECT_EQ(again.left.camera->toText(), rig.left.camera->toText());
    EXPECT_EQ(again.right.camera->toText(), rig.right.camera->toText());
  }
}

TEST(StereoFiles, ProgramsForOneCameraReadTheLeftOne) {
  const StereoRig rig = crooked();
  for (const auto& text : {toText(rig), toMrptText(rig)}) {
    const CameraRig left = parseCamera(text, "text");
    EXPECT_EQ(left.camera->toText(), rig.left.camera->toText());
    EXPECT_TRUE(left.T_robot_cam.isApprox(rig.left.T_robot_cam, 1e-12));
  }
}

/// The oracle is MRPT: it reads what we write, and we read what it writes.
TEST(StereoFiles, MrptReadsOurFileAndWeReadIts) {
  const StereoRig rig = crooked();
  mrpt::config::CConfigFileMemory ours(toMrptText(rig));
  mrpt::img::TStereoCamera camera;
  camera.loadFromConfigFile("CAMERA_PARAMS", ours);
  EXPECT_EQ(camera.leftCamera.ncols, 752U);
  EXPECT_NEAR(camera.rightCamera.fy(), 456.1, 1e-9);
  EXPECT_NEAR(camera.leftCamera.k2(), 0.074, 1e-12);
  EXPECT_NEAR(camera.leftCamera.p1(), 2e-4, 1e-15);
  EXPECT_NEAR(camera.rightCameraPose.x, 0.11, 1e-12);
  mrpt::config::CConfigFileMemory theirs;
  camera.saveToConfigFile("HEAD", theirs);
  const StereoRig again = parseStereoRig(theirs.getContent(), "mrpt");
  EXPECT_TRUE(again.T_left_right().isApprox(rig.T_left_right(), 1e-5));  // MRPT writes six digits
  const auto pixel = again.right.camera->project({0.3, -0.2, 1}),
             truth = rig.right.camera->project({0.3, -0.2, 1});
  EXPECT_LT((*pixel - *truth).norm(), 1e-3);
}

TEST(StereoFiles, MistakesAreNamed) {
  const std::string left = "[camera]\nmodel=pinhole\nwidth=64\nheight=48\nfov_deg=90\n";
  const std::string right = "[right]\nmodel=pinhole\nwidth=64\nheight=48\nfov_deg=90\n";
  EXPECT_THAT(message(left), HasSubstr("describes one camera"));
  EXPECT_THAT(message(left + right), HasSubstr("[right_pose]"));
  EXPECT_THAT(message(left + right + "[right_pose]\nx=0.1\nbaseline=3\n"),
              AllOf(HasSubstr("rig.ini:13"), HasSubstr("baseline")));
  EXPECT_THAT(message(left + "[right]\nmodel=pinhole\nwidth=64\n[right_pose]\nx=0.1\n"),
              HasSubstr("[right] height is missing"));
  std::string mrpt = toMrptText(crooked());
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = mrpt;
    text.replace(text.find(from), from.size(), to);
    return message(text);
  };
  EXPECT_THAT(replaced("resolution = [752 480]", "resolution = [752]"), HasSubstr("[width height]"));
  for (const char* size : {"1e300 480", "0 480", "-752 480", "752.5 480", "752 32769"})
    EXPECT_THAT(replaced("resolution = [752 480]", std::string("resolution = [") + size + "]"),
                HasSubstr("whole numbers of 1 to 32768"))
        << size;
  EXPECT_THAT(replaced("resolution = [752 480]", "resolution = [32768 32768]"), HasSubstr("67108864"));
  EXPECT_THAT(replaced("fx = ", "fx = a"), AllOf(HasSubstr("rig.ini:5"), HasSubstr("is not a number")));
  EXPECT_THAT(replaced("plumb_bob", "kannala_brandt"), HasSubstr("'kannala_brandt' is not supported"));
  EXPECT_THAT(replaced("_RIGHT]", "_WRONG]"), HasSubstr("no section [CAMERA_PARAMS_RIGHT]"));
  EXPECT_THAT(replaced("pose_quaternion = [", "pose_quaternion = [7 "), HasSubstr("expected [x y z"));
}

/// Points of the scene, seen by both cameras as they are, must lie in one row after rectification, where the
/// model says. This compares OpenCV's maps with our own camera model.
TEST(Rectifier, PointsLandWhereTheModelSays) {
  const StereoRig rig = crooked();
  const Rectifier rectifier(rig);
  EXPECT_FALSE(rectifier.identity());
  const auto& model = rectifier.model();
  EXPECT_NEAR(model.baseline, rig.T_left_right().translation().norm(), 1e-12);
  base::Rng rng(2);
  const auto draw = [](const CameraRig& camera, const Eigen::Vector3d& point) {
    const auto at = camera.camera->project(camera.T_robot_cam.inverse() * point);
    cv::Mat image(480, 752, CV_8U, cv::Scalar(0));
    // A blob of known centre, to a sixteenth of a pixel.
    cv::circle(image,
               {static_cast<int>(std::lround(at->x() * 16)), static_cast<int>(std::lround(at->y() * 16))},
               6 * 16, cv::Scalar(255), cv::FILLED, cv::LINE_AA, 4);
    cv::GaussianBlur(image, image, {}, 1);
    return image;
  };
  const auto centre = [](const cv::Mat& image) {
    const cv::Moments m = cv::moments(image);
    return Eigen::Vector2d(m.m10 / m.m00, m.m01 / m.m00);
  };
  for (int trial = 0; trial < 10; ++trial) {
    const double z = rng.uniform(1.5, 5);
    const Eigen::Vector3d inRectified(z * rng.uniform(-0.5, 0.5), z * rng.uniform(-0.35, 0.35), z);
    const Eigen::Vector3d point = rectifier.T_robot_cam() * inRectified;
    const auto pair = rectifier(draw(rig.left, point), draw(rig.right, point));
    const types::StereoPoint expected = model.project(inRectified);
    const Eigen::Vector2d left = centre(pair.left), right = centre(pair.right);
    EXPECT_NEAR(left.x(), expected.u, 0.15);
    EXPECT_NEAR(left.y(), expected.v, 0.15);
    EXPECT_NEAR(right.y(), left.y(), 0.1);
    EXPECT_NEAR(left.x() - right.x(), expected.disparity, 0.2);
  }
}

TEST(Rectifier, RectifiedImagesAreLeftAlone) {
  const StereoRig rig = loadStereoRig(kShare + "stereo_world.ini");
  const Rectifier rectifier(rig);
  EXPECT_TRUE(rectifier.identity());
  EXPECT_NEAR(rectifier.model().baseline, 0.09, 1e-12);
  EXPECT_NEAR(rectifier.model().f, 320, 1e-9);
  cv::Mat left(480, 640, CV_8UC3), right(480, 640, CV_8U);
  cv::randu(left, 0, 255);
  cv::randu(right, 0, 255);
  const auto pair = rectifier(left, right);
  cv::Mat grey;
  cv::cvtColor(left, grey, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(cv::norm(pair.left, grey, cv::NORM_INF), 0);
  EXPECT_EQ(pair.right.data, right.data);
  EXPECT_TRUE(rectifier.T_robot_cam().isApprox(rig.left.T_robot_cam));
}

TEST(Rectifier, RefusesWhatCannotBeRectified) {
  const auto refusal = [](const std::function<void(StereoRig&)>& spoil) {
    StereoRig rig = crooked();
    spoil(rig);
    return message([&] { Rectifier{rig}; });
  };
  EXPECT_THAT(refusal([](StereoRig& r) { std::swap(r.left, r.right); }), HasSubstr("exchanged"));
  EXPECT_THAT(refusal([](StereoRig& r) {
                r.right.T_robot_cam = r.left.T_robot_cam * Eigen::Translation3d(0, 0.1, 0);
              }),
              HasSubstr("side by side"));
  EXPECT_THAT(refusal([](StereoRig& r) { r.right = r.left; }), HasSubstr("side by side"));
  EXPECT_THAT(refusal([](StereoRig& r) { r.right.camera = r.right.camera->scaled(0.5, 0.5); }),
              AllOf(HasSubstr("752x480"), HasSubstr("376x240")));
  EXPECT_THAT(refusal([](StereoRig& r) { r.left = loadCamera(kShare + "omni_world.ini"); }),
              HasSubstr("unified_sphere"));
  const Rectifier rectifier(crooked());
  const cv::Mat good(480, 752, CV_8U, cv::Scalar(0)), small(240, 376, CV_8U, cv::Scalar(0));
  EXPECT_THAT(message([&] { rectifier(good, small); }), AllOf(HasSubstr("right"), HasSubstr("376x240")));
  EXPECT_THAT(message([&] { rectifier(good, {}); }), HasSubstr("right image is missing"));
}

}  // namespace
}  // namespace engram::cameras::stereo_rig

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/perception.h"

#include "engram/base/error.h"
#include "engram/cameras/unified_sphere.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <numbers>

namespace engram::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const cv::Mat& picture() { return engram::testing::firstDrive().frames[3].image; }

CameraParams omni() { return engram::testing::tinyParams().camera; }

TEST(Perception, FirstImageOfAnotherSizeIsAnError) {
  Perception perception(omni(), {});
  try {
    perception.refusal(cv::Mat(600, 800, CV_8UC3, cv::Scalar::all(0)));
    FAIL() << "accepted";
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("800x600"), HasSubstr("640x480"), HasSubstr("[camera] file")));
  }
}

TEST(Perception, LaterImageOfAnotherSizeIsRefusedInWords) {
  Perception perception(omni(), {});
  EXPECT_THAT(perception.refusal(picture()), IsEmpty());
  EXPECT_THAT(perception.refusal(cv::Mat(600, 800, CV_8UC3)),
              AllOf(HasSubstr("800x600"), HasSubstr("640x480")));
  EXPECT_THAT(perception.refusal(cv::Mat{}), HasSubstr("empty"));
  EXPECT_THAT(perception.refusal(picture()), IsEmpty());
}

TEST(Perception, MissingCalibrationIsAnErrorThatNamesTheFile) {
  try {
    Perception perception({.file = "no/such/camera.ini"}, {});
    FAIL() << "accepted";
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("no/such/camera.ini"));
  }
}

TEST(Perception, UncalibratedCameraIsAPinholeOfTheGivenField) {
  CameraParams params;
  params.fov = 70 * std::numbers::pi / 180;
  Perception perception(params, {});
  ASSERT_THAT(perception.refusal(picture()), IsEmpty());
  EXPECT_THAT(perception.refusal(cv::Mat(240, 320, CV_8UC3)), HasSubstr("320x240"));
  const types::Features f = perception(picture());
  ASSERT_GT(f.size(), 100u);
  // Camera forward is robot x, right is -y, down is -z; the image's border is at half the field of view.
  const double focal = 320.0 / std::tan(params.fov / 2);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Eigen::Vector3d expected(focal, -(f.keypoints[i].x - 319.5), -(f.keypoints[i].y - 239.5));
    EXPECT_LT((f.bearings[i].cast<double>() - expected.normalized()).norm(), 1e-3) << i;
  }
}

TEST(Perception, DescriptorsAreQuantisedAndTheHeaderSaysSo) {
  Perception perception(omni(), {});
  ASSERT_THAT(perception.refusal(picture()), IsEmpty());
  const types::Features f = perception(picture());
  EXPECT_EQ(f.descriptors.kind(), types::DescriptorKind::kInt8);
  EXPECT_EQ(f.bearings.size(), f.size());
  const map::MapHeader header = perception.mapHeader("fsh");
  EXPECT_EQ(header.extractor, "surf");
  EXPECT_EQ(header.descriptorKind, types::DescriptorKind::kInt8);
  EXPECT_EQ(header.descriptorDim, f.descriptors.dim());
  EXPECT_EQ(header.memoryModel, "fsh");
  EXPECT_THAT(header.camera, HasSubstr("unified_sphere"));

  features::ExtractorParams orb;
  orb.extractor = "orb";
  EXPECT_EQ(Perception(omni(), orb).mapHeader("fsh").descriptorKind, types::DescriptorKind::kBinary);
}

/// Features of the full and of the scaled image that see the same point have the same bearing.
TEST(Perception, ScaledImagesGiveTheSameBearings) {
  CameraParams half = omni();
  half.image_width = 320;
  Perception full(omni(), {}), scaled(half, {});
  ASSERT_THAT(full.refusal(picture()), IsEmpty());
  ASSERT_THAT(scaled.refusal(picture()), IsEmpty());  // images come as before
  EXPECT_THAT(scaled.refusal(cv::Mat(240, 320, CV_8UC3)), HasSubstr("320x240"));
  const types::Features a = full(picture()), b = scaled(picture());
  ASSERT_GT(b.size(), 100u);
  int pairs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k) {
      const double x = 2 * b.keypoints[k].x + 0.5, y = 2 * b.keypoints[k].y + 0.5;  // pixel centres
      const double apart = std::hypot(a.keypoints[i].x - x, a.keypoints[i].y - y);
      if (apart > 1.0) continue;
      ++pairs;
      // A pixel is at least 1/fx / (1 + xi) ... 2/fx of angle: a bound for one pixel.
      EXPECT_LT((a.bearings[i] - b.bearings[k]).norm(), 2.0 / 141.9 * (apart + 0.1));
    }
  EXPECT_GT(pairs, 50);
}

TEST(Perception, BlackAndEvenImagesHaveNoFeatures) {
  for (const char* name : {"surf", "sift", "akaze", "orb"})
    for (const int grey : {0, 128, 255}) {
      features::ExtractorParams extractor;
      extractor.extractor = name;
      Perception perception(CameraParams{}, extractor);
      const cv::Mat even(240, 320, CV_8UC3, cv::Scalar::all(grey));
      ASSERT_THAT(perception.refusal(even), IsEmpty());
      EXPECT_TRUE(perception(even).empty()) << name << ' ' << grey;
    }
}

TEST(Perception, GreyImageGivesNearlyTheFeaturesOfTheColourOne) {
  Perception perception(omni(), {});
  ASSERT_THAT(perception.refusal(picture()), IsEmpty());
  cv::Mat grey;
  cv::cvtColor(picture(), grey, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(perception(grey).descriptors, perception(picture()).descriptors);
}

/// F-E17: the conic is that of the mirror, in its own frame, for cameras that look up and down.
TEST(Perception, TheConicHasTheFrameAndTheMirrorOfTheCalibration) {
  geometry::VerifyParams verify;
  verify.residual = "conic";
  for (const double roll : {0.0, std::numbers::pi}) {
    cameras::CameraRig rig = cameras::loadCamera(omni().file);
    rig.T_robot_cam.linear() =
        Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()).toRotationMatrix() * rig.T_robot_cam.linear();
    const auto* mirror = dynamic_cast<const cameras::UnifiedSphere*>(rig.camera.get());
    ASSERT_NE(mirror, nullptr);
    Perception perception(rig, {});
    const geometry::VerifyParams params = perception.withOptics(verify);
    EXPECT_EQ(params.conic_xi, mirror->xi());
    ASSERT_THAT(perception.refusal(picture()), IsEmpty());
    const types::Features f = perception(picture());
    ASSERT_GT(f.size(), 50u);
    for (std::size_t i = 0; i < f.size(); i += 7) {
      const Eigen::Vector3d ray = params.R_optics_ray * f.bearings[i].cast<double>();
      const auto pixel = rig.camera->project(ray);
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x(), f.keypoints[i].x, 0.6);
      EXPECT_NEAR(pixel->y(), f.keypoints[i].y, 0.6);
    }
  }
  verify.conic_xi = 0.5;
  EXPECT_EQ(Perception(omni(), {}).withOptics(verify).conic_xi, 0.5) << "a value that is given stays";
}

}  // namespace
}  // namespace engram::pipeline

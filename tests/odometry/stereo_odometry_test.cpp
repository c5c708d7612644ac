// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/stereo_odometry.h"

#include "engram/base/error.h"
#include "world_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace engram::odometry {
namespace {

using namespace testing_world;
using Eigen::Isometry3d;

constexpr double kStep = 0.06;  // [m]
constexpr double kDegree = M_PI / 180;

const Rectified& drive() {
  static const Rectified pairs = rectify(smallRig(), driveThroughOffice(smallRig(), 24, kStep));
  return pairs;
}

/// Far from that drive.
const Rectified& elsewhere() {
  static const Rectified pairs = rectify(smallRig(), driveThroughOffice(smallRig(), 3, kStep, 20));
  return pairs;
}

double angle(const Isometry3d& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

/// Chains the motions; every frame but the first must be found.
std::vector<Isometry3d> chain(StereoOdometry& odometry, const Rectified& frames) {
  std::vector<Isometry3d> poses;
  Isometry3d keyframe = frames.T_world_cam.front();
  for (std::size_t i = 0; i < frames.pairs.size(); ++i) {
    const auto result = odometry.process(frames.pairs[i]);
    EXPECT_EQ(result.reason, i == 0 ? OdometryReason::kFirst : OdometryReason::kOk) << i;
    poses.push_back(keyframe * result.T_keyframe_now.T_a_b);
    if (result.newKeyframe) keyframe = poses.back();
  }
  return poses;
}

void expectDrift(const Rectified& frames, double share, double degrees) {
  StereoOdometry odometry(frames.rectifier.model(), frames.rectifier.mask(), {});
  const auto poses = chain(odometry, frames);
  const Isometry3d is = poses.front().inverse() * poses.back();
  const Isometry3d was = frames.T_world_cam.front().inverse() * frames.T_world_cam.back();
  EXPECT_LT((was.inverse() * is).translation().norm(), share * was.translation().norm());
  EXPECT_LT(angle(was.inverse() * is), degrees * kDegree);
}

TEST(StereoOdometry, FollowsTheTour) { expectDrift(drive(), 0.015, 0.5); }

TEST(StereoOdometry, FollowsItWithACrookedHead) {
  expectDrift(rectify(crookedRig(), driveThroughOffice(crookedRig(), 16, kStep)), 0.02, 0.5);
}

TEST(StereoOdometry, AlwaysAgainstTheLastKeyframe) {
  OdometryParams params;
  params.keyframe_distance = 0.1;
  params.keyframe_score = 0;
  StereoOdometry odometry(drive().rectifier.model(), {}, params);
  double moved = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    const auto result = odometry.process(drive().pairs[i]);
    moved = i == 0 ? 0 : moved + kStep;
    EXPECT_NEAR(result.T_keyframe_now.T_a_b.translation().norm(), moved, 0.01) << i;
    EXPECT_EQ(result.newKeyframe, i == 0 || moved > 0.1) << i;
    if (result.newKeyframe) moved = 0;
  }
}

TEST(StereoOdometry, FewPointsFoundAgainMakeAKeyframe) {
  OdometryParams params;
  params.keyframe_score = 1;  // never all of them
  StereoOdometry odometry(drive().rectifier.model(), {}, params);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(odometry.process(drive().pairs[i]).newKeyframe);
}

/// The errors against what the covariance says: in units of their deviations, squared, the median of many is
/// that of six degrees of freedom, 5.35, if image noise were all; textures and corners add some.
TEST(StereoOdometry, CovarianceIsOfTheSizeOfTheErrors) {
  StereoOdometry odometry(drive().rectifier.model(), {}, {});
  std::vector<double> nees;
  Isometry3d keyframe = drive().T_world_cam.front();
  for (std::size_t i = 0; i < drive().pairs.size(); ++i) {
    const auto result = odometry.process(drive().pairs[i]);
    const Isometry3d error =
        result.T_keyframe_now.T_a_b.inverse() * keyframe.inverse() * drive().T_world_cam[i];
    if (result.newKeyframe) keyframe = drive().T_world_cam[i];
    if (!result.ok()) continue;
    const Eigen::AngleAxisd turn(error.linear());
    Eigen::Matrix<double, 6, 1> d;
    d << error.translation(), turn.angle() * turn.axis();
    nees.push_back(d.dot(result.T_keyframe_now.cov.ldlt().solve(d)));
  }
  std::sort(nees.begin(), nees.end());
  EXPECT_GT(nees[nees.size() / 2], 1);
  EXPECT_LT(nees[nees.size() / 2], 25);
}

TEST(StereoOdometry, SameFramesSameResults) {
  StereoOdometry one(drive().rectifier.model(), {}, {}), two(drive().rectifier.model(), {}, {});
  for (std::size_t i = 0; i < 6; ++i) {
    const auto a = one.process(drive().pairs[i]), b = two.process(drive().pairs[i]);
    EXPECT_EQ(a.T_keyframe_now.T_a_b.matrix(), b.T_keyframe_now.T_a_b.matrix());
    EXPECT_EQ(a.T_keyframe_now.cov, b.T_keyframe_now.cov);
    EXPECT_EQ(a.inliers, b.inliers);
  }
}

TEST(StereoOdometry, DescriptorsBridgeWhatTrackingCannot) {
  const Rectified sparse = rectify(smallRig(), driveThroughOffice(smallRig(), 5, 0.7));
  const auto failures = [&](bool wide) {
    OdometryParams params;
    params.wide_baseline = wide;
    StereoOdometry odometry(sparse.rectifier.model(), {}, params);
    int failed = 0;
    for (std::size_t i = 0; i < sparse.pairs.size(); ++i) {
      const auto result = odometry.process(sparse.pairs[i]);
      if (i == 0) continue;
      failed += !result.ok();
      if (!result.ok()) continue;
      const Isometry3d was = sparse.T_world_cam[i - 1].inverse() * sparse.T_world_cam[i];
      EXPECT_LT((was.inverse() * result.T_keyframe_now.T_a_b).translation().norm(), 0.06) << i;
    }
    return failed;
  };
  EXPECT_EQ(failures(true), 0);
  EXPECT_GT(failures(false), 0);
}

TEST(StereoOdometry, ACoveredCameraFindsItsWayBack) {
  const auto& frames = drive();
  const cv::Mat black(240, 320, CV_8U, cv::Scalar(7));
  StereoOdometry odometry(frames.rectifier.model(), {}, {});
  odometry.process(frames.pairs[0]);
  auto result = odometry.process({black, black});
  EXPECT_EQ(result.reason, OdometryReason::kTooFewCorners);
  EXPECT_FALSE(result.newKeyframe);
  result = odometry.process({black, frames.pairs[1].right});
  EXPECT_EQ(result.reason, OdometryReason::kTooFewCorners);
  result = odometry.process({frames.pairs[1].left, black});
  EXPECT_EQ(result.reason, OdometryReason::kTooFewPoints);
  EXPECT_TRUE(result.T_keyframe_now.T_a_b.isApprox(Isometry3d::Identity()));
  result = odometry.process(frames.pairs[2]);
  EXPECT_EQ(result.reason, OdometryReason::kOk);
  EXPECT_NEAR(result.T_keyframe_now.T_a_b.translation().norm(), 2 * kStep, 0.01);
}

/// K-E10: after a failure the frame becomes the keyframe.
TEST(StereoOdometry, AJumpBeginsAnewFromTheFrameItself) {
  StereoOdometry odometry(drive().rectifier.model(), {}, {});
  odometry.process(drive().pairs[0]);
  auto result = odometry.process(elsewhere().pairs[0]);
  EXPECT_THAT(result.reason, testing::AnyOf(OdometryReason::kTooFewMatches, OdometryReason::kTooFewInliers));
  EXPECT_TRUE(result.newKeyframe);
  result = odometry.process(elsewhere().pairs[1]);
  EXPECT_TRUE(result.ok());
  EXPECT_NEAR(result.T_keyframe_now.T_a_b.translation().norm(), kStep, 0.01);
  odometry.reset();
  EXPECT_EQ(odometry.process(elsewhere().pairs[2]).reason, OdometryReason::kFirst);
}

TEST(StereoOdometry, KnownMotionSaysWhereToLook) {
  // A turn of 20 degrees at once, by shifting the order of a tour through a bend of the route.
  const auto& frames = drive();
  OdometryParams params;
  params.wide_baseline = false;
  params.track_levels = 1;  // a reach of some pixels only
  StereoOdometry blind(frames.rectifier.model(), {}, params), told(frames.rectifier.model(), {}, params);
  blind.process(frames.pairs[0]);
  told.process(frames.pairs[0]);
  const auto without = blind.process(frames.pairs[5]);
  const auto with = told.process(frames.pairs[5], frames.T_world_cam[0].inverse() * frames.T_world_cam[5]);
  ASSERT_TRUE(with.ok());
  EXPECT_GT(with.inliers, without.inliers + 20);
}

TEST(StereoOdometry, BadImagesAreAnError) {
  StereoOdometry odometry(drive().rectifier.model(), {}, {});
  const cv::Mat grey(240, 320, CV_8U, cv::Scalar(0)), colour(240, 320, CV_8UC3, cv::Scalar::all(0)),
      small(120, 160, CV_8U, cv::Scalar(0));
  EXPECT_THROW(odometry.process({colour, colour}), base::Error);
  EXPECT_THROW(odometry.process({grey, small}), base::Error);
  EXPECT_THROW(odometry.process({grey, {}}), base::Error);
  OdometryParams wrong;
  wrong.min_inliers = 3;
  EXPECT_THROW(StereoOdometry(drive().rectifier.model(), {}, wrong), base::ConfigError);
}

}  // namespace
}  // namespace engram::odometry

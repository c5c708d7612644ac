// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/odometry/params.h"
#include "engram/types/rel_pose.h"
#include "engram/types/stereo.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace engram::odometry {

enum class OdometryReason : std::uint8_t {
  kOk,
  kFirst,          ///< there is no keyframe yet; this frame became one
  kTooFewCorners,  ///< the left image shows less than `min_inliers` corners: blank, dark, covered
  kTooFewPoints,   ///< less than `min_inliers` of them were found in the right image
  kTooFewMatches,  ///< less than `min_inliers` points of the keyframe were found again
  kTooFewInliers,  ///< less than `min_inliers` of those agree with one motion (K-09)
  kLowRatio,       ///< a smaller share of them than `min_inlier_ratio`
  kDegenerate,     ///< they determine no motion, e.g. all lie on one line
};

const char* toString(OdometryReason reason);

/// The motion of one frame against the last keyframe, or why there is none.
struct OdometryResult {
  OdometryReason reason = OdometryReason::kFirst;
  /// Pose of the left camera in that of the keyframe [m]; the identity with zero covariance without one.
  types::RelPose T_keyframe_now{.cov = types::Matrix6d::Zero()};
  bool newKeyframe = false;   ///< this frame is the keyframe of the next
  bool wideBaseline = false;  ///< found by descriptors, tracking had failed
  int points = 0;             ///< of the keyframe
  int matches = 0;            ///< of these, found in both eyes of this frame
  int inliers = 0;            ///< of these, in agreement with the motion
  double sigma = 0;           ///< noise of one image coordinate, from the residuals [px]

  bool ok() const { return reason == OdometryReason::kOk; }
};

/// Visual odometry from a rectified stereo camera, always against the last keyframe (K-04): FAST corners on a
/// grid, disparities by correlation along the rows, tracking from where the motion is expected to have taken
/// them, RANSAC on three 3D points, refinement with covariance (K-08). K tracks by correlation of patches
/// with the corners of the new image; we use the pyramid of Lucas & Kanade (OpenCV's), which needs no corner
/// there.
///
/// A new keyframe is due after a distance, a turn, or when few points are found again (K-20). After a failure
/// the frame becomes the keyframe (K-E10), unless it shows too little itself: then the old one stays, so that
/// a camera that is covered for a moment finds its way back. The same frames give the same results.
class StereoOdometry {
 public:
  /// @param mask of the left image, CV_8U, 0 where nothing is to be used; may be empty.
  StereoOdometry(const types::StereoModel& model, cv::Mat mask, const OdometryParams& params);
  ~StereoOdometry();
  StereoOdometry(StereoOdometry&&) noexcept;
  StereoOdometry& operator=(StereoOdometry&&) noexcept;

  /// @param T_last_now the motion since the last frame, where it is known from elsewhere (wheels); otherwise
  /// it is taken to be that of the frame before.
  /// Throws base::Error when the images are not CV_8UC1 of one size.
  OdometryResult process(const types::StereoPair& pair,
                         const std::optional<Eigen::Isometry3d>& T_last_now = std::nullopt);

  /// Forgets the keyframe: the next frame is the first.
  void reset();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::odometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/geometry/verify.h"
#include "engram/types/features.h"
#include "engram/types/match.h"
#include "engram/types/rel_pose.h"
#include "engram/types/stereo.h"

#include <Eigen/Geometry>

#include <span>
#include <string>
#include <vector>

namespace engram::geometry {

/// One scene point in two rectified stereo pairs.
struct StereoMatch {
  types::StereoPoint a, b;  ///< disparities must be positive
};

/// When two stereo views show one rigid scene.
struct StereoVerifyParams {
  int min_inliers = 30;  ///< K-09, K-15: no false positives from here on; V-06 has 10
  double min_inlier_ratio = 0;
  std::string vote = "reprojection";
  double max_error = 2;        ///< [px]
  double depth_precision = 1;  ///< [px]
  int sample_points = 3;
  double confidence = 0.999;
  int max_iterations = 500;
  int seed = 1;

  void describe(base::Params& p);
};

struct StereoEstimate {
  types::RelPose T_a_b;
  double sigma = 0;  ///< noise of one image coordinate, from the residuals [px]
};

struct StereoVerification {
  Reason reason = Reason::kTooFewMatches;
  std::vector<int> inliers;  ///< indices into the matches, ascending; filled even when the reason is not kOk
  types::RelPose T_a_b;      ///< pose of the left camera b in the left camera a [m]
  double sigma = 0;          ///< noise of one image coordinate, from the residuals of the inliers [px]
  int iterations = 0;        ///< of RANSAC

  bool ok() const { return reason == Reason::kOk; }
};

/// Do these matches come from one rigid scene (K-08)? RANSAC on samples of three 3D points, with a test of
/// their mutual distances before the pose is computed; the hypothesis with most inliers is refined by
/// refineStereo(). The same arguments give the same result.
StereoVerification verifyStereo(std::span<const StereoMatch> matches, const types::StereoModel& model,
                                const StereoVerifyParams& params);

/// The same for features of rectified left images that have ranges; matches without a range are ignored.
StereoVerification verifyStereo(const types::Features& a, const types::Features& b,
                                std::span<const types::Match> matches, const types::StereoModel& model,
                                const StereoVerifyParams& params);

/// The rigid motion that takes points of b to a with the least squared distances: V eq (1) to (3) (Kanatani,
/// by singular values as Umeyama 1991). Needs three points or more.
Eigen::Isometry3d alignPoints(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

/// Least squares of the reprojection error in both eyes (Levenberg-Marquardt), from `start`. Each residual is
/// weighed by what noise in the images of a and of b makes of it, to first order, so a distant point, whose
/// depth is uncertain, still tells the rotation. The covariance is that of the noise seen in the residuals
/// through the inverse Hessian. Residuals beyond 2.5 of their deviations count linearly (Huber).
StereoEstimate refineStereo(std::span<const StereoMatch> matches, const types::StereoModel& model,
                            const Eigen::Isometry3d& start, int maxIterations = 10);

}  // namespace engram::geometry

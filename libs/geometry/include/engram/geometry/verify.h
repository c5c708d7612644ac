// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/types/features.h"
#include "engram/types/match.h"
#include "engram/types/rel_pose.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace engram::geometry {

/// When two views count as views of one place.
struct VerifyParams {
  std::string model = "planar";
  int min_inliers = 10;
  double min_inlier_ratio = 0.1;
  double max_angle = 0.0174533;  ///< [rad]
  double max_log10_nfa = -4;
  double confidence = 0.999;
  int max_iterations = 2000;
  int seed = 1;
  std::string residual = "angular";
  double conic_xi = 0;
  double max_conic_distance = 0.01;
  /// residual = conic: from the frame of the bearings to that of the optics, whose z is the axis of the
  /// mirror or lens. No key: who knows the calibration sets it, see pipeline::withOptics().
  Eigen::Matrix3d R_optics_ray = Eigen::Matrix3d::Identity();

  void describe(base::Params& p);
};

enum class Reason : std::uint8_t {
  kOk,
  kTooFewMatches,  ///< fewer matches than `min_inliers`
  kDegenerate,     ///< the matches determine no motion, e.g. all lie on the horizon or in one point
  kTooFewInliers,  ///< fewer than `min_inliers`
  kLowRatio,       ///< a smaller share of the matches than `min_inlier_ratio`
  kAccidental,     ///< as many inliers as unrelated images can have: `max_log10_nfa`
};

const char* toString(Reason reason);

struct Verification {
  Reason reason = Reason::kTooFewMatches;
  std::vector<int> inliers;  ///< indices into the matches, ascending; filled even when the reason is not kOk
  /// Pose of camera b in camera a, without scale. The translation is zero when the parallax is insignificant.
  /// The covariance holds only what was estimated: see TwoViewEstimate::cov.
  types::RelPose T_a_b{.cov = types::Matrix6d::Zero(), .hasScale = false};
  double meanError = 0;  ///< mean angle between the inliers and their epipolar planes [rad]
  double log10Nfa = 0;   ///< log10 of the expected number of equally good accidental models
  int iterations = 0;    ///< of RANSAC

  bool ok() const { return reason == Reason::kOk; }
};

/// Do these matches come from one rigid scene? RANSAC on unit bearings, refinement over the inliers,
/// cheirality, and a test against accidental agreement, whose probability is measured on the same rays paired
/// at random. Matches without a ray (zero bearing) are ignored. The same arguments give the same result.
/// @param a,b views with bearings; `matches` index into them.
/// @param up_cam the robot's up axis in the camera frame, the same in both views; only the planar model uses
/// it.
Verification verify(const types::Features& a, const types::Features& b, std::span<const types::Match> matches,
                    const Eigen::Vector3d& up_cam, const VerifyParams& params);

}  // namespace engram::geometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/geometry/stereo_verify.h"

#include <array>
#include <span>
#include <vector>

namespace engram::geometry {

/// Which matches agree with a motion.
class StereoInliers {
 public:
  /// Throws base::Error for a disparity that is not positive.
  StereoInliers(std::span<const StereoMatch> matches, const types::StereoModel& model,
                const StereoVerifyParams& params);

  int size() const { return static_cast<int>(a_.size()); }
  int count(const Eigen::Isometry3d& T_b_a) const;
  std::vector<int> list(const Eigen::Isometry3d& T_b_a) const;

  const std::vector<Eigen::Vector3d>& pointsA() const { return a_; }  ///< [m]
  const std::vector<Eigen::Vector3d>& pointsB() const { return b_; }
  /// How much further or nearer the points of a match can be for a mistake of one pixel in the disparity: the
  /// root of the sum of squares over both views [m].
  const std::vector<double>& depthNoise() const { return depthNoise_; }

 private:
  float squaredError(const Eigen::Isometry3f& T_b_a, std::size_t i) const;

  std::vector<Eigen::Vector3d> a_, b_;
  std::vector<double> depthNoise_;
  std::vector<float> rayX_, rayY_, nearness_;  // of a: ray (x, y, 1), 1 / depth
  std::vector<float> left_, row_, right_;      // measured in b, divided by the focal length
  std::vector<float> voteLimit_;               // squared [m^2]; only for the vote by depth
  float baseline_, limit_;                     // [m], squared [1]
  bool byDepth_;
};

/// Rigid motion for ransac(): N matched 3D points, one model.
template <int N>
class RigidProblem {
 public:
  using Model = Eigen::Isometry3d;  // T_b_a
  static constexpr int kSampleSize = N, kMaxModels = 1;

  explicit RigidProblem(const StereoInliers& inliers) : inliers_(inliers) {}

  int size() const { return inliers_.size(); }
  int solve(const std::array<int, N>& sample, std::array<Model, 1>& models) const;
  int countInliers(const Model& T_b_a) const { return inliers_.count(T_b_a); }

 private:
  bool rigid(const std::array<int, N>& sample) const;
  const StereoInliers& inliers_;
};

}  // namespace engram::geometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "epipolar.h"

#include <span>
#include <vector>

namespace engram::geometry {

/// When a pair of rays agrees with an essential matrix.
struct InlierTest {
  double sine = 0;     ///< of the largest angle between a ray and the epipolar plane of its partner
  bool conic = false;  ///< F eq (1) instead: distance of a from the conic of b, in the normalised plane
  double xi = 1;       ///< mirror parameter of the conic
  double maxConicDistance = 0;                                 ///< [px / focal length]
  Eigen::Matrix3d R_optics_ray = Eigen::Matrix3d::Identity();  ///< conic: z is the axis of the optics there

  bool operator()(const Eigen::Matrix3d& E_a_b, const BearingPair& pair) const;
};

/// Pairs as parallel arrays, for counting with vector instructions.
struct PairArrays {
  std::vector<float> ax, ay, az, bx, by, bz;
  explicit PairArrays(std::span<const BearingPair> pairs);
};

/// Planar motion for ransac(): two pairs, up to two models. Works in a frame with z up.
class PlanarProblem {
 public:
  using Model = PlanarMotion;
  static constexpr int kSampleSize = 2, kMaxModels = 2;

  /// @param R_cam_level takes the level frame (z up) to the camera frame, in which the pairs are given.
  PlanarProblem(std::span<const BearingPair> pairs, const Eigen::Matrix3d& R_cam_level,
                const InlierTest& test);

  int size() const { return static_cast<int>(pairs_.size()); }
  int solve(const std::array<int, 2>& sample, std::array<Model, 2>& models) const;
  int countInliers(const Model& model) const;
  TwoViewPose poseInCamera(const Model& model) const;

 private:
  std::span<const BearingPair> pairs_;
  std::vector<BearingPair> level_;
  Eigen::Matrix3d R_cam_level_;
  InlierTest test_;
  PairArrays arrays_;  // of level_
};

/// Any motion for ransac(): eight pairs, one essential matrix.
class EssentialProblem {
 public:
  using Model = Eigen::Matrix3d;
  static constexpr int kSampleSize = 8, kMaxModels = 1;

  EssentialProblem(std::span<const BearingPair> pairs, const InlierTest& test);

  int size() const { return static_cast<int>(pairs_.size()); }
  int solve(const std::array<int, 8>& sample, std::array<Model, 1>& models) const;
  int countInliers(const Model& model) const;

 private:
  std::span<const BearingPair> pairs_;
  InlierTest test_;
  PairArrays arrays_;
};

/// Rotation without translation for ransac(): two pairs, one model.
class RotationProblem {
 public:
  using Model = Eigen::Matrix3d;
  static constexpr int kSampleSize = 2, kMaxModels = 1;

  /// @param sine of the largest angle between a ray and its turned partner.
  RotationProblem(std::span<const BearingPair> pairs, double sine) : pairs_(pairs), sine_(sine) {}

  int size() const { return static_cast<int>(pairs_.size()); }
  int solve(const std::array<int, 2>& sample, std::array<Model, 1>& models) const;
  int countInliers(const Model& R_a_b) const;

 private:
  std::span<const BearingPair> pairs_;
  double sine_;
};

}  // namespace engram::geometry

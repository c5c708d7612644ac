// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/rel_pose.h"
#include "epipolar.h"

#include <optional>
#include <span>

namespace engram::geometry {

struct TwoViewEstimate {
  TwoViewPose pose;  ///< t_a_b is zero when only the rotation was fitted
  /// As in types::RelPose: of d = (translation, rotation vector) with T_true = T exp(d). Only what was
  /// estimated has variance: the scale never, tilt and height not in planar motion.
  types::Matrix6d cov = types::Matrix6d::Zero();
  double sigma = 0;  ///< noise of one bearing along one axis, from the residuals [rad]
};

/// Least squares over all pairs (Levenberg-Marquardt) of the first-order distance on the sphere,
/// a^T E b / sqrt(|E b|^2 + |E^T a|^2) [rad], from `start`. With `up` the motion stays planar: rotation about
/// `up`, translation orthogonal to it, as in `start`; without, all five degrees of freedom move.
TwoViewEstimate refine(std::span<const BearingPair> pairs, const TwoViewPose& start,
                       const std::optional<Eigen::Vector3d>& up, int maxIterations = 10);

/// The rotation that explains the pairs best without any translation, robust against pairs that it does not
/// explain; its `sigma` comes from the pairs within `maxAngle` [rad].
TwoViewEstimate fitRotation(std::span<const BearingPair> pairs, const Eigen::Matrix3d& start,
                            const std::optional<Eigen::Vector3d>& up, double maxAngle);

}  // namespace engram::geometry

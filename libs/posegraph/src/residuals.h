// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/graph.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <memory>

namespace engram::posegraph {

/// A pose in a parameter block of 7: translation, then quaternion (x, y, z, w).
using PoseBlock = std::array<double, 7>;

PoseBlock toBlock(const Eigen::Isometry3d& T);
Eigen::Isometry3d fromBlock(const PoseBlock& block);

/// Moves a pose T to T exp(d), as covariances do (K-E2). Cost functions here give their derivative by d in
/// the first six columns of a block and zeros in the seventh; this manifold passes those six on.
class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* d, double* out) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* out) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// Whitened residual over the blocks (x, y, yaw) of both ends, 3 numbers. With scale: SE(2) logarithm of the
/// gap. Without: sine of the angle between the directions and the yaw, and a third that keeps the direction
/// from settling on its opposite, where the sine is zero too.
std::unique_ptr<ceres::CostFunction> planarCost(const types::RelPose& T_a_b);

/// Whitened residual over the PoseBlocks of both ends, 6 numbers. With scale: K-E2. Without: direction on its
/// tangent plane (2), rotation (3), and the guard against the opposite direction.
std::unique_ptr<ceres::CostFunction> spatialCost(const types::RelPose& T_a_b);

}  // namespace engram::posegraph

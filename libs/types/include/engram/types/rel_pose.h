// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace engram::types {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Where b is, seen from a: T_a_b takes coordinates in b to a.
struct RelPose {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  /// Covariance of the small motion d = (translation [m], rotation vector [rad]) with T_true = T_a_b *
  /// exp(d).
  Matrix6d cov = Matrix6d::Identity();
  /// False for two views of one camera: the translation is then a unit vector, or zero for pure rotation.
  bool hasScale = true;
};

}  // namespace engram::types

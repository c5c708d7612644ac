// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/rel_pose.h"

#include <Eigen/Geometry>

namespace engram::types {

// The algebra of relative poses: small motions d = (translation [m], rotation vector [rad]) act on the right,
// T exp(d), as in RelPose. Every covariance that comes out is symmetric to the last bit.

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// W with W x = w × x.
Eigen::Matrix3d skew(const Eigen::Vector3d& w);

/// SE(3) logarithm (translation part, rotation vector) and its inverse.
Vector6d logSe3(const Eigen::Isometry3d& T);
Eigen::Isometry3d expSe3(const Vector6d& v);

/// Takes a small motion of a frame to the frame that T leads to: T exp(d) = exp(adjoint(T) d) T.
Matrix6d adjoint(const Eigen::Isometry3d& T);

/// Inverse of the left Jacobian of SO(3): log(exp(d) exp(w)) = w + J d.
Eigen::Matrix3d inverseLeftJacobian(const Eigen::Vector3d& w);
/// The same of SE(3), translation before rotation (Barfoot, State Estimation for Robotics, eq 7.86 and 7.95).
Matrix6d inverseLeftJacobian(const Vector6d& v);

/// The mean of a matrix and its transpose.
Matrix6d symmetric(const Matrix6d& m);
/// Covariance of A d where d has this one: A cov A^T.
Matrix6d transported(const Matrix6d& cov, const Matrix6d& A);

/// One motion after the other, and the motion back; covariances to first order, as independent (K-12 with
/// K-E3). What has no scale on the way has none at the end.
RelPose compose(const RelPose& T_a_b, const RelPose& T_b_c);
RelPose inverse(const RelPose& T_a_b);
/// The motion of a frame `a` fixed to `c`, when c moves by T_c0_c1 and T_a_c is how it is mounted.
RelPose seenBy(const Eigen::Isometry3d& T_a_c, const RelPose& T_c0_c1);

/// A rotation without the rounding that long chains of products gather.
Eigen::Isometry3d rigid(Eigen::Isometry3d T);

}  // namespace engram::types

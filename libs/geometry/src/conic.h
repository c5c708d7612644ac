// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace engram::geometry {

/// Point of the normalised plane of the unified sphere model: (X, Y, 1) / (Z + xi) of a unit ray.
Eigen::Vector3d toNormalisedPlane(const Eigen::Vector3d& ray, double xi);

/// F eq (1): the conic v^T C v = 0 on which the points of the plane with this normal appear.
/// It holds in the normalised plane, not in pixels, and has a second branch of points that are not in the
/// plane: those whose other intersection with the sphere is (F-E17).
Eigen::Matrix3d epipolarConic(const Eigen::Vector3d& normal, double xi);

/// First-order distance of a point from a conic (Sampson 1982) [units of the normalised plane, px / focal
/// length].
double conicDistance(const Eigen::Matrix3d& conic, const Eigen::Vector3d& point);

}  // namespace engram::geometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "conic.h"

#include <algorithm>
#include <cmath>

namespace engram::geometry {

Eigen::Vector3d toNormalisedPlane(const Eigen::Vector3d& ray, double xi) {
  const double d = ray.z() + xi;
  return {ray.x() / d, ray.y() / d, 1};
}

Eigen::Matrix3d epipolarConic(const Eigen::Vector3d& n, double xi) {
  const double k = 1 - xi * xi, m = n.z() * n.z() * xi * xi;
  const double xy = n.x() * n.y() * k, xz = n.x() * n.z(), yz = n.y() * n.z();
  Eigen::Matrix3d C;
  C << n.x() * n.x() * k - m, xy, xz, xy, n.y() * n.y() * k - m, yz, xz, yz, n.z() * n.z();
  return C;
}

double conicDistance(const Eigen::Matrix3d& conic, const Eigen::Vector3d& point) {
  const Eigen::Vector3d gradient = conic * point;  // half of it
  return std::abs(point.dot(gradient)) / std::max(2 * gradient.head<2>().norm(), 1e-12);
}

}  // namespace engram::geometry

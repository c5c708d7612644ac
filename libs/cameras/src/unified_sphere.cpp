// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/unified_sphere.h"

#include "calibration_text.h"
#include "engram/base/error.h"

#include <algorithm>
#include <cmath>

namespace engram::cameras {
namespace {

constexpr double kMargin = 1e-9;  // keeps away from the rays where the derivative is infinite

double lowestVisibleZ(double xi) { return -(xi > 1 ? 1 / xi : xi) + kMargin; }

}  // namespace

UnifiedSphere::UnifiedSphere(cv::Size size, double xi, const ImagePlaneParams& plane)
    : size_(size), xi_(xi), lowestZ_(lowestVisibleZ(xi)), plane_(plane) {
  checkSize(size);
  if (!(xi >= 0) || std::isinf(xi)) throw base::Error("unified_sphere camera: xi must be 0 or more");
}

std::optional<Eigen::Vector2d> UnifiedSphere::project(const Eigen::Vector3d& p, Matrix23d* J) const {
  const double n = p.norm();
  if (!(n > 0) || !(p.z() > lowestZ_ * n)) return std::nullopt;
  const double d = p.z() + xi_ * n;
  const Eigen::Vector2d m = p.head<2>() / d;
  Eigen::Matrix2d J_pixel_m;
  const auto pixel = plane_.toPixel(m, J ? &J_pixel_m : nullptr);
  if (pixel && J) {
    const Eigen::RowVector3d J_d_point = Eigen::RowVector3d(0, 0, 1) + xi_ / n * p.transpose();
    Matrix23d J_m_point = -m * J_d_point;
    J_m_point.leftCols<2>() += Eigen::Matrix2d::Identity();
    *J = J_pixel_m * J_m_point / d;
  }
  return pixel;
}

std::optional<Eigen::Vector3d> UnifiedSphere::unproject(const Eigen::Vector2d& pixel, Matrix32d* J) const {
  Eigen::Matrix2d J_m_pixel;
  const auto m = plane_.toPlane(pixel, J ? &J_m_pixel : nullptr);
  if (!m) return std::nullopt;
  const double s = m->squaredNorm();
  const double root2 = 1 + (1 - xi_ * xi_) * s;
  if (!(root2 > 0)) return std::nullopt;  // the line misses the sphere
  const double root = std::sqrt(root2);
  const double lambda = (xi_ + root) / (1 + s);
  const Eigen::Vector3d ray(lambda * m->x(), lambda * m->y(), lambda - xi_);
  if (!(ray.z() > lowestZ_)) return std::nullopt;
  if (J) {
    const double dLambda = (0.5 * (1 - xi_ * xi_) / root - lambda) / (1 + s);  // by s
    Matrix32d J_ray_m;
    J_ray_m.topRows<2>() = lambda * Eigen::Matrix2d::Identity() + 2 * dLambda * *m * m->transpose();
    J_ray_m.row(2) = 2 * dLambda * m->transpose();
    *J = J_ray_m * J_m_pixel;
  }
  return ray;
}

std::string UnifiedSphere::toText() const {
  CalibrationText text{
      .model = model(), .width = size_.width, .height = size_.height, .xi = xi_, .plane = plane()};
  return text.dump();
}

std::shared_ptr<const Camera> UnifiedSphere::scaled(double factorX, double factorY) const {
  return std::make_shared<UnifiedSphere>(scaledSize(size_, factorX, factorY), xi_,
                                         ImagePlane::scaled(plane(), factorX, factorY));
}

}  // namespace engram::cameras

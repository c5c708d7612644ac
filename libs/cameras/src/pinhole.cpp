// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/pinhole.h"

#include "calibration_text.h"
#include "engram/base/error.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace engram::cameras {

Pinhole::Pinhole(cv::Size size, const ImagePlaneParams& plane) : size_(size), plane_(plane) {
  checkSize(size);
}

std::optional<Eigen::Vector2d> Pinhole::project(const Eigen::Vector3d& p, Matrix23d* J) const {
  if (!(p.z() > 1e-9 * p.norm())) return std::nullopt;
  const Eigen::Vector2d m = p.head<2>() / p.z();
  Eigen::Matrix2d J_pixel_m;
  const auto pixel = plane_.toPixel(m, J ? &J_pixel_m : nullptr);
  if (pixel && J) {
    Matrix23d J_m_point;
    J_m_point << 1, 0, -m.x(), 0, 1, -m.y();
    *J = J_pixel_m * J_m_point / p.z();
  }
  return pixel;
}

std::optional<Eigen::Vector3d> Pinhole::unproject(const Eigen::Vector2d& pixel, Matrix32d* J) const {
  Eigen::Matrix2d J_m_pixel;
  const auto m = plane_.toPlane(pixel, J ? &J_m_pixel : nullptr);
  if (!m) return std::nullopt;
  const double length = std::sqrt(1 + m->squaredNorm());
  const Eigen::Vector3d ray = m->homogeneous() / length;
  if (J) {
    const Eigen::Matrix3d J_ray_point = (Eigen::Matrix3d::Identity() - ray * ray.transpose()) / length;
    *J = J_ray_point.leftCols<2>() * J_m_pixel;
  }
  return ray;
}

std::string Pinhole::toText() const {
  CalibrationText text{.model = model(), .width = size_.width, .height = size_.height, .plane = plane()};
  return text.dump();
}

std::shared_ptr<const Camera> Pinhole::scaled(double factorX, double factorY) const {
  return std::make_shared<Pinhole>(scaledSize(size_, factorX, factorY),
                                   ImagePlane::scaled(plane(), factorX, factorY));
}

std::shared_ptr<const Camera> approximatePinhole(cv::Size size, double horizontalFov) {
  if (!(horizontalFov > 0 && horizontalFov < std::numbers::pi))
    throw base::Error("pinhole camera: the horizontal field of view must lie between 0 and 180 degrees");
  ImagePlaneParams plane;
  plane.fx = plane.fy = 0.5 * size.width / std::tan(0.5 * horizontalFov);
  plane.cx = 0.5 * (size.width - 1);
  plane.cy = 0.5 * (size.height - 1);
  return std::make_shared<Pinhole>(size, plane);
}

}  // namespace engram::cameras

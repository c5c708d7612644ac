// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/equirectangular.h"

#include "calibration_text.h"

#include <cmath>
#include <numbers>

namespace engram::cameras {

Equirectangular::Equirectangular(cv::Size size)
    : size_(size),
      pixelsPerLongitude_(size.width / (2 * std::numbers::pi)),
      pixelsPerLatitude_(size.height / std::numbers::pi) {
  checkSize(size);
}

std::optional<Eigen::Vector2d> Equirectangular::project(const Eigen::Vector3d& p, Matrix23d* J) const {
  const double n2 = p.squaredNorm();
  const double h2 = p.x() * p.x() + p.z() * p.z();
  if (!(h2 > 1e-24 * n2)) return std::nullopt;
  const double h = std::sqrt(h2);
  if (J) {
    J->row(0) = pixelsPerLongitude_ / h2 * Eigen::RowVector3d(p.z(), 0, -p.x());
    J->row(1) = pixelsPerLatitude_ / (n2 * h) * Eigen::RowVector3d(-p.x() * p.y(), h2, -p.z() * p.y());
  }
  return Eigen::Vector2d(0.5 * (size_.width - 1) + pixelsPerLongitude_ * std::atan2(p.x(), p.z()),
                         0.5 * (size_.height - 1) + pixelsPerLatitude_ * std::atan2(p.y(), h));
}

std::optional<Eigen::Vector3d> Equirectangular::unproject(const Eigen::Vector2d& pixel, Matrix32d* J) const {
  const double longitude = (pixel.x() - 0.5 * (size_.width - 1)) / pixelsPerLongitude_;
  const double latitude = (pixel.y() - 0.5 * (size_.height - 1)) / pixelsPerLatitude_;
  if (!std::isfinite(longitude) || !(std::abs(latitude) <= 0.5 * std::numbers::pi)) return std::nullopt;
  const double so = std::sin(longitude), co = std::cos(longitude);
  const double sa = std::sin(latitude), ca = std::cos(latitude);
  if (J) {
    J->col(0) = Eigen::Vector3d(ca * co, 0, -ca * so) / pixelsPerLongitude_;
    J->col(1) = Eigen::Vector3d(-sa * so, ca, -sa * co) / pixelsPerLatitude_;
  }
  return Eigen::Vector3d(ca * so, sa, ca * co);
}

std::string Equirectangular::toText() const {
  CalibrationText text{.model = model(), .width = size_.width, .height = size_.height};
  return text.dump();
}

std::shared_ptr<const Camera> Equirectangular::scaled(double factorX, double factorY) const {
  return std::make_shared<Equirectangular>(scaledSize(size_, factorX, factorY));
}

}  // namespace engram::cameras

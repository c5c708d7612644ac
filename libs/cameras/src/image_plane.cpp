// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/image_plane.h"

#include "engram/base/error.h"

#include <Eigen/LU>
#include <opencv2/core.hpp>

#include <cmath>
#include <limits>

namespace engram::cameras {
namespace {

/// Smallest positive root s = r^2 of 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3: there the distorted radius stops
/// growing.
double findFold(const ImagePlaneParams& p) {
  const cv::Vec4d coefficients(7 * p.k3, 5 * p.k2, 3 * p.k1, 1);
  cv::Vec3d roots;
  const int n = cv::solveCubic(coefficients, roots);
  double fold = std::numeric_limits<double>::infinity();
  for (int i = 0; i < n; ++i)
    if (roots[i] > 0 && roots[i] < fold) fold = roots[i];
  return fold;
}

double radialFactor(const ImagePlaneParams& p, double s) { return 1 + s * (p.k1 + s * (p.k2 + s * p.k3)); }

}  // namespace

ImagePlane::ImagePlane(const ImagePlaneParams& params)
    : params_(params),
      distorts_(params.k1 != 0 || params.k2 != 0 || params.k3 != 0 || params.p1 != 0 || params.p2 != 0),
      foldRadiusSquared_(findFold(params)) {
  if (!(std::abs(params.fx) > 0) || !(std::abs(params.fy) > 0))
    throw base::Error("camera: fx and fy must not be zero; give the focal lengths in pixels");
}

Eigen::Vector2d ImagePlane::distort(const Eigen::Vector2d& plane, Eigen::Matrix2d& J) const {
  const auto& [fx, fy, cx, cy, skew, k1, k2, k3, p1, p2] = params_;
  const double x = plane.x(), y = plane.y(), s = plane.squaredNorm();
  const double g = radialFactor(params_, s);
  const double dg = k1 + s * (2 * k2 + s * 3 * k3);  // by s
  const double mixed = 2 * x * y * dg + 2 * p1 * x + 2 * p2 * y;
  J << g + 2 * x * x * dg + 2 * p1 * y + 6 * p2 * x, mixed, mixed,
      g + 2 * y * y * dg + 6 * p1 * y + 2 * p2 * x;
  return {x * g + 2 * p1 * x * y + p2 * (s + 2 * x * x), y * g + p1 * (s + 2 * y * y) + 2 * p2 * x * y};
}

bool ImagePlane::inDomain(const Eigen::Vector2d& plane, const Eigen::Matrix2d& J) const {
  return plane.squaredNorm() < foldRadiusSquared_ && J.determinant() > 1e-9 && J.trace() > 0;
}

std::optional<Eigen::Vector2d> ImagePlane::toPixel(const Eigen::Vector2d& plane, Eigen::Matrix2d* J) const {
  Eigen::Matrix2d K;
  K << params_.fx, params_.skew, 0, params_.fy;
  Eigen::Matrix2d D = Eigen::Matrix2d::Identity();
  Eigen::Vector2d distorted = plane;
  if (distorts_) {
    distorted = distort(plane, D);
    if (!inDomain(plane, D)) return std::nullopt;
  }
  if (J) *J = K * D;
  const Eigen::Vector2d pixel = K * distorted + Eigen::Vector2d(params_.cx, params_.cy);
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

/// Inverse of r -> r (1 + k1 r^2 + ...) by bisection-guarded Newton steps; close to the fold where there is
/// none.
double ImagePlane::undistortedRadius(double wanted) const {
  const double fold = std::sqrt(foldRadiusSquared_);
  double low = 0, high = std::isinf(fold) ? 1 : 0.999 * fold;
  if (std::isinf(fold))
    while (high * radialFactor(params_, high * high) < wanted && high < 1e12) high *= 2;
  double r = std::min(wanted, 0.5 * (low + high));
  for (int i = 0; i < 40; ++i) {
    const double s = r * r;
    const double error = r * radialFactor(params_, s) - wanted;
    (error > 0 ? high : low) = r;
    const double slope = 1 + s * (3 * params_.k1 + s * (5 * params_.k2 + s * 7 * params_.k3));
    const double step = r - error / slope;
    const double next = step > low && step < high ? step : 0.5 * (low + high);
    if (std::abs(next - r) < 1e-14 * (1 + r)) return next;
    r = next;
  }
  return r;
}

std::optional<Eigen::Vector2d> ImagePlane::toPlane(const Eigen::Vector2d& pixel, Eigen::Matrix2d* J) const {
  const double yd = (pixel.y() - params_.cy) / params_.fy;
  const Eigen::Vector2d distorted((pixel.x() - params_.cx - params_.skew * yd) / params_.fx, yd);
  if (!distorted.allFinite()) return std::nullopt;
  Eigen::Matrix2d K, D = Eigen::Matrix2d::Identity();
  K << params_.fx, params_.skew, 0, params_.fy;
  Eigen::Vector2d plane = distorted;
  if (distorts_) {
    const double radius = distorted.norm();
    if (radius > 0) plane *= undistortedRadius(radius) / radius;  // exact without tangential terms
    Eigen::Vector2d error = distort(plane, D) - distorted;
    for (int i = 0; i < 20 && error.norm() > 1e-14 * (1 + radius); ++i) {
      if (!inDomain(plane, D)) return std::nullopt;
      plane -= D.inverse() * error;
      error = distort(plane, D) - distorted;
    }
    if (!(error.norm() < 1e-10 * (1 + radius)) || !inDomain(plane, D)) return std::nullopt;
  }
  if (J) *J = (K * D).inverse();
  return plane;
}

ImagePlaneParams ImagePlane::scaled(ImagePlaneParams p, double factorX, double factorY) {
  p.fx *= factorX;
  p.skew *= factorX;
  p.fy *= factorY;
  p.cx = (p.cx + 0.5) * factorX - 0.5;  // pixel centres are whole numbers, so the image begins at -0.5
  p.cy = (p.cy + 0.5) * factorY - 0.5;
  return p;
}

}  // namespace engram::cameras

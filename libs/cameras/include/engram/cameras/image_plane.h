// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"

#include <Eigen/Core>

#include <optional>

namespace engram::cameras {

/// Camera matrix and lens distortion (`plumb_bob`, Brown 1966): what follows the projection onto the plane z
/// = 1.
struct ImagePlaneParams {
  double fx = 1, fy = 1;          ///< focal lengths [px], not zero; negative for a mirrored axis
  double cx = 0, cy = 0;          ///< principal point [px]
  double skew = 0;                ///< [px]: u = fx x + skew y + cx
  double k1 = 0, k2 = 0, k3 = 0;  ///< radial distortion
  double p1 = 0, p2 = 0;          ///< tangential distortion
  bool operator==(const ImagePlaneParams&) const = default;
};

/// Normalised plane coordinates to pixels and back. Valid up to the radius where the radial distortion folds
/// back.
class ImagePlane {
 public:
  explicit ImagePlane(const ImagePlaneParams& params);

  const ImagePlaneParams& params() const { return params_; }

  /// Pixel of a plane point; none beyond the fold of the distortion.
  std::optional<Eigen::Vector2d> toPixel(const Eigen::Vector2d& plane,
                                         Eigen::Matrix2d* J_pixel_plane = nullptr) const;

  /// Plane point of a pixel (Newton's method on the distortion); none where there is no such point.
  std::optional<Eigen::Vector2d> toPlane(const Eigen::Vector2d& pixel,
                                         Eigen::Matrix2d* J_plane_pixel = nullptr) const;

  /// The parameters for an image scaled by these factors.
  static ImagePlaneParams scaled(ImagePlaneParams params, double factorX, double factorY);

 private:
  Eigen::Vector2d distort(const Eigen::Vector2d& plane, Eigen::Matrix2d& J) const;
  double undistortedRadius(double distortedRadius) const;
  bool inDomain(const Eigen::Vector2d& plane, const Eigen::Matrix2d& J) const;

  ImagePlaneParams params_;
  bool distorts_;
  double foldRadiusSquared_;  // smallest r^2 with d(distorted r)/dr = 0, or infinity
};

}  // namespace engram::cameras

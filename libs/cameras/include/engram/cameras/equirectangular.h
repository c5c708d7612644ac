// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera.h"

namespace engram::cameras {

/// A panorama of the full sphere. Columns are longitudes about the y axis, rows are latitudes; the middle of
/// the image is +z, a quarter of the width to its right is +x, the bottom row is near +y (down). The left
/// border (u = -0.5) and the right one (u = width - 0.5) are the same half circle behind the camera, -z.
class Equirectangular final : public Camera {
 public:
  explicit Equirectangular(cv::Size size);

  std::string model() const override { return "equirectangular"; }
  cv::Size imageSize() const override { return size_; }
  /// None only for the origin and for points on the y axis, whose column is undefined. Columns are in
  /// [-0.5, width - 0.5].
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_cam,
                                         Matrix23d* J_pixel_point = nullptr) const override;
  /// Columns outside the image wrap around; rows outside it have no ray.
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel,
                                           Matrix32d* J_ray_pixel = nullptr) const override;
  std::string toText() const override;
  std::shared_ptr<const Camera> scaled(double factorX, double factorY) const override;

 private:
  cv::Size size_;
  double pixelsPerLongitude_, pixelsPerLatitude_;  // [px/rad]
};

}  // namespace engram::cameras

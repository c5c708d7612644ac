// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera.h"
#include "engram/cameras/image_plane.h"

namespace engram::cameras {

/// Perspective camera with `plumb_bob` distortion. Sees points with z > 0.
class Pinhole final : public Camera {
 public:
  Pinhole(cv::Size size, const ImagePlaneParams& plane);

  const ImagePlaneParams& plane() const { return plane_.params(); }

  std::string model() const override { return "pinhole"; }
  cv::Size imageSize() const override { return size_; }
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_cam,
                                         Matrix23d* J_pixel_point = nullptr) const override;
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel,
                                           Matrix32d* J_ray_pixel = nullptr) const override;
  std::string toText() const override;
  std::shared_ptr<const Camera> scaled(double factorX, double factorY) const override;

 private:
  cv::Size size_;
  ImagePlane plane_;
};

/// A camera nobody calibrated: square pixels, no distortion, principal point in the centre of the image.
/// @param horizontalFov angle between the left and the right border of the image [rad], in (0, pi).
std::shared_ptr<const Camera> approximatePinhole(cv::Size size, double horizontalFov);

}  // namespace engram::cameras

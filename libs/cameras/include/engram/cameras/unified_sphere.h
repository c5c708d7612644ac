// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera.h"
#include "engram/cameras/image_plane.h"

namespace engram::cameras {

/// Central catadioptric and fisheye cameras: unified sphere model of Mei & Rives 2007, as in `cv::omnidir`.
/// A point goes to the unit sphere, from there through the centre (0, 0, -xi) to the plane, then distortion
/// and camera matrix. xi = 0 is a perspective camera, about 0.8 to 1 a mirror, 1 a parabolic mirror, more a
/// wide fisheye.
///
/// The ray through the middle of the image is +z. For the usual camera below a convex mirror that is the
/// direction *down* to the robot; the horizon is a circle around it, and rays above the horizon (z < 0) are
/// outside that circle. Seen are rays with z > -min(xi, 1/xi): beyond, two rays would share a pixel.
class UnifiedSphere final : public Camera {
 public:
  /// @param xi distance of the centre of projection from that of the sphere, >= 0.
  UnifiedSphere(cv::Size size, double xi, const ImagePlaneParams& plane);

  double xi() const { return xi_; }
  const ImagePlaneParams& plane() const { return plane_.params(); }

  std::string model() const override { return "unified_sphere"; }
  cv::Size imageSize() const override { return size_; }
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_cam,
                                         Matrix23d* J_pixel_point = nullptr) const override;
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel,
                                           Matrix32d* J_ray_pixel = nullptr) const override;
  std::string toText() const override;
  std::shared_ptr<const Camera> scaled(double factorX, double factorY) const override;

 private:
  cv::Size size_;
  double xi_;
  double lowestZ_;  // rays with z above this are seen
  ImagePlane plane_;
};

}  // namespace engram::cameras

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include <memory>
#include <optional>
#include <string>

namespace engram::cameras {

using Matrix23d = Eigen::Matrix<double, 2, 3>;
using Matrix32d = Eigen::Matrix<double, 3, 2>;

/// A central camera: pixels to rays and back. Pixel (0, 0) is the centre of the top left pixel.
/// The camera frame has z along the optical axis, x right, y down.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Name of the model as in calibration files: `unified_sphere`, `pinhole`, `equirectangular`.
  virtual std::string model() const = 0;
  virtual cv::Size imageSize() const = 0;

  /// Image of a 3D point [m] in the camera frame; none where the model does not see it. It may lie outside
  /// the image.
  /// @param J_pixel_point derivative of the pixel by the point, when wanted.
  virtual std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_cam,
                                                 Matrix23d* J_pixel_point = nullptr) const = 0;

  /// Unit ray of a pixel; none where no ray of the model meets it.
  /// @param J_ray_pixel derivative of the ray by the pixel, when wanted.
  virtual std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel,
                                                   Matrix32d* J_ray_pixel = nullptr) const = 0;

  /// The calibration as the text of a calibration file: loadable, and equal for equal cameras.
  virtual std::string toText() const = 0;

  /// The same camera for an image scaled by these factors.
  virtual std::shared_ptr<const Camera> scaled(double factorX, double factorY) const = 0;
};

}  // namespace engram::cameras

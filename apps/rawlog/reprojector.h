// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera_rig.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <vector>

namespace engram::apps {

/// Shows an image of one camera as another camera at the same spot would see it. Only directions matter, so
/// both cameras are taken to have the same centre of projection.
class Reprojector {
 public:
  /// @param from camera of the given images. @param to camera of the wanted images; its mask becomes black.
  Reprojector(cameras::CameraRig from, cameras::CameraRig to);

  /// @param heading by which the robot is turned to the left about the vertical against the robot of the
  /// image [rad].
  /// @param image of the size of the first camera, 8 bit, 1 or 3 channels; another size throws base::Error.
  cv::Mat operator()(const cv::Mat& image, double heading) const;

  /// Samples per pixel and axis, so that no detail of the source is skipped.
  int oversampling() const { return factor_; }

 private:
  void castRays();
  int chooseFactor() const;
  std::optional<Eigen::Vector3d> rayOf(double x, double y) const;

  cameras::CameraRig from_, to_;
  bool wraps_;  // the left and right border of the source meet
  int factor_ = 1;
  cv::Size fine_;                      // size of the oversampled image
  std::vector<Eigen::Vector3f> rays_;  // of each of its pixels, in the robot's frame; zero: none
};

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera_rig.h"

#include <opencv2/core/mat.hpp>

#include <optional>
#include <vector>

namespace engram::appearance {

/// What a camera that sees all round shows around the horizon: a strip whose columns are headings from ahead
/// to the left, a full turn, and whose rows are elevations from high to low.
class Panorama {
 public:
  /// None for a camera that does not see all round.
  static std::optional<Panorama> of(const cameras::CameraRig& rig);

  /// @param picture of this camera, at any scale. @param size of the strip [px]
  /// @return of the type of `picture`; black where the camera sees nothing
  cv::Mat strip(const cv::Mat& picture, cv::Size size) const;

 private:
  explicit Panorama(const cameras::CameraRig& rig) : rig_(rig) {}

  cameras::CameraRig rig_;
};

}  // namespace engram::appearance

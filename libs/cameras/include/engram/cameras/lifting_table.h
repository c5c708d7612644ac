// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera.h"
#include "engram/cameras/camera_rig.h"
#include "engram/types/features.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace engram::cameras {

/// Pixels to unit rays by a table over all pixels (F-09, F-11), bilinear in between. Where the table has a
/// gap or ends, the camera model itself is asked.
class LiftingTable {
 public:
  explicit LiftingTable(const CameraRig& rig);

  /// Unit ray of an image point [px]; none where the model has none.
  std::optional<Eigen::Vector3f> bearing(float x, float y) const;

  /// Unit rays of keypoints, one each. The zero vector where the model has none, which imageMask() excludes.
  std::vector<Eigen::Vector3f> bearings(std::span<const types::Keypoint> keypoints) const;

  /// CV_8U, 255 where the rig's mask allows and a ray exists.
  const cv::Mat& imageMask() const { return mask_; }

 private:
  std::shared_ptr<const Camera> camera_;
  cv::Mat mask_;
  int width_, height_;
  std::vector<Eigen::Vector3f> rays_;  // row after row; zero: none
};

/// The mask without the `radius` [px] next to its borders, so that features of that radius lie wholly inside.
/// The borders of the image do not count: detectors know them.
cv::Mat erodedMask(const cv::Mat& mask, int radius);

}  // namespace engram::cameras

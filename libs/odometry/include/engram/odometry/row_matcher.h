// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/stereo.h"

#include <opencv2/core/mat.hpp>

#include <optional>
#include <span>
#include <vector>

namespace engram::odometry {

/// Disparities of points by correlation along the rows of a rectified pair: the smallest sum of absolute
/// differences of 16 x 11 pixels of the horizontal gradient, small, distinct, found again from right to left,
/// and refined on the grey levels to a fraction of a pixel. Brightness may differ between the eyes.
class RowMatcher {
 public:
  /// @param maxDisparity largest one sought [px]
  RowMatcher(const types::StereoPair& pair, int maxDisparity);

  /// Disparity of a point of the left image [px], positive; none where nothing or no single thing fits.
  std::optional<float> disparity(float u, float v) const;
  /// The same within `reach` pixels of an expected disparity.
  std::optional<float> disparity(float u, float v, float expected, int reach) const;

 private:
  std::optional<float> search(float u, float v, int low, int high) const;
  std::optional<float> refine(float u, float v, int start) const;

  cv::Mat left_, right_;  // smoothed: interpolation shifts what is sharp
  cv::Mat gradientLeft_, gradientRight_;
  int maxDisparity_;
};

}  // namespace engram::odometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace engram::types {

/// What a sensor saw at one instant.
///
/// Frames: `odom` is where odometry began; `robot` has x forward, y left, z up; `cam` has z along the optical
/// axis, x right, y down in the image.
struct Frame {
  std::uint64_t index = 0;  ///< running number in its source, from 0
  double stamp = 0.0;       ///< [s] since the Unix epoch, or since the start where the source knows no better
  std::string label;        ///< image file or sensor label, for messages
  cv::Mat image;            ///< 8 bit, 1 or 3 (BGR) channels
  cv::Mat right;            ///< right image of a stereo pair; empty for one camera
  std::optional<Eigen::Isometry3d>
      T_odom_robot;  ///< odometry interpolated to `stamp`; absent when the source has none
};

}  // namespace engram::types

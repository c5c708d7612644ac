// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <cmath>

namespace engram::types {

/// Two rectified images taken at the same time: a point of the scene is in the same row of both.
struct StereoPair {
  cv::Mat left, right;  ///< CV_8UC1, of the same size
};

/// Where a point is in a rectified pair: pixel (u, v) of the left image, (u - disparity, v) of the right one.
struct StereoPoint {
  double u = 0, v = 0, disparity = 0;  ///< [px]
};

/// Geometry of a rectified pair: two pinholes without distortion, parallel, with one camera matrix.
struct StereoModel {
  double f = 1;           ///< focal length [px]
  double cx = 0, cy = 0;  ///< principal point [px]
  double baseline = 0.1;  ///< the right camera is at (baseline, 0, 0) in the frame of the left one [m]

  /// The point [m] in the frame of the left camera. The disparity must be positive.
  Eigen::Vector3d toPoint(const StereoPoint& p) const {
    const double z = f * baseline / p.disparity;
    return {(p.u - cx) * z / f, (p.v - cy) * z / f, z};
  }
  /// The image of a point with z > 0.
  StereoPoint project(const Eigen::Vector3d& point) const {
    const double s = f / point.z();
    return {s * point.x() + cx, s * point.y() + cy, s * baseline};
  }
};

/// A keypoint of a rectified left image with the distance of its point [m]; the range must be positive.
inline StereoPoint stereoPoint(const Keypoint& k, float range, const StereoModel& m) {
  const double x = (k.x - m.cx) / m.f, y = (k.y - m.cy) / m.f;
  return {k.x, k.y, m.f * m.baseline * std::sqrt(1 + x * x + y * y) / range};
}

/// The other way round: the distance of a point seen there, 0 where its disparity is not positive.
inline float rangeOf(const StereoPoint& p, const StereoModel& m) {
  return p.disparity > 0 ? static_cast<float>(m.toPoint(p).norm()) : 0.0f;
}

}  // namespace engram::types

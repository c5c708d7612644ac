// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keyframe.h"

#include "corners.h"

#include <opencv2/video/tracking.hpp>

namespace engram::odometry {

View::View(const types::StereoPair& pair, const OdometryParams& params)
    : pair_(pair), rows_(pair, params.max_disparity) {
  buildPyramid(params, false);
}

/// Tracking needs the derivatives of the image that the points come from only.
void View::buildPyramid(const OdometryParams& params, bool derivatives) {
  cv::buildOpticalFlowPyramid(pair_.left, pyramid_, {params.track_window, params.track_window},
                              params.track_levels - 1, derivatives);
}

void View::findPoints(const cv::Mat& mask, const OdometryParams& params) {
  const auto found = gridCorners(pair_.left, mask, params.max_corners, params.corner_threshold);
  corners_ = static_cast<int>(found.size());
  points_.clear();
  buildPyramid(params, true);
  for (const auto& corner : found)
    if (const auto d = rows_.disparity(corner.x, corner.y)) points_.push_back({corner.x, corner.y, *d});
}

}  // namespace engram::odometry

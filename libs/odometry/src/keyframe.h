// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/odometry/params.h"
#include "engram/odometry/row_matcher.h"
#include "engram/types/features.h"
#include "engram/types/stereo.h"

#include <opencv2/core/mat.hpp>

#include <optional>
#include <vector>

namespace engram::odometry {

/// A frame and what was computed of it; the rest is computed when it is needed.
class View {
 public:
  View(const types::StereoPair& pair, const OdometryParams& params);

  const types::StereoPair& pair() const { return pair_; }
  const std::vector<cv::Mat>& pyramid() const { return pyramid_; }
  const RowMatcher& rows() const { return rows_; }

  /// Finds corners and their disparities: only a keyframe has them.
  void findPoints(const cv::Mat& mask, const OdometryParams& params);
  int corners() const { return corners_; }
  const std::vector<types::StereoPoint>& points() const { return points_; }

  std::optional<types::Features> features;  ///< with ranges; of WideBaseline

 private:
  void buildPyramid(const OdometryParams& params, bool derivatives);

  types::StereoPair pair_;
  std::vector<cv::Mat> pyramid_;
  RowMatcher rows_;
  int corners_ = 0;
  std::vector<types::StereoPoint> points_;
};

}  // namespace engram::odometry

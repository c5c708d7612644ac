// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"

namespace engram::odometry {

/// Section [odometry].
struct OdometryParams {
  int max_corners = 400;
  int corner_threshold = 8;
  int max_disparity = 128;
  int track_window = 16;
  int track_levels = 4;
  double max_error = 1.5;
  int min_inliers = 30;  ///< K-09
  double min_inlier_ratio = 0.3;
  double keyframe_distance = 0.3;
  double keyframe_angle = 0.17453292519943295;  ///< [rad]; K-20
  double keyframe_score = 0.4;
  bool wide_baseline = true;
  int seed = 1;

  void describe(base::Params& p);
};

}  // namespace engram::odometry

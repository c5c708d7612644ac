// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/params.h"

namespace engram::odometry {

void OdometryParams::describe(base::Params& p) {
  p.add("max_corners", max_corners, "corners of a keyframe, evenly spread", {30, 5000});
  p.add("corner_threshold", corner_threshold, "contrast of a FAST corner, in grey levels", {2, 100});
  p.add("max_disparity", max_disparity, "largest disparity sought [px]: nearer points are not seen",
        {8, 1000});
  p.add("track_window", track_window, "side of the patch that is tracked [px]", {7, 41});
  p.add("track_levels", track_levels, "levels of the image pyramid in tracking", {1, 6});
  p.add("max_error", max_error, "largest reprojection error of an inlier in either eye [px]", {0.1, 20});
  p.add("min_inliers", min_inliers, "points that must agree with the motion", {6, 5000});
  p.add(
      "min_inlier_ratio", min_inlier_ratio,
      "share of the points found again that must agree: a small one is that of something that moves, or of a "
      "pattern that repeats",
      {0, 1});
  p.add("keyframe_distance", keyframe_distance, "a new keyframe after this distance [m]", {0.01, 1000});
  p.addDegrees("keyframe_angle", keyframe_angle, "a new keyframe after this turn [deg]", {0.1, 180});
  p.add("keyframe_score", keyframe_score,
        "a new keyframe when a smaller share of the keyframe's points is found again", {0, 1});
  p.add("wide_baseline", wide_baseline, "match descriptors where tracking fails");
  p.add("seed", seed, "of the random samples", {0, 2147483647});
}

}  // namespace engram::odometry

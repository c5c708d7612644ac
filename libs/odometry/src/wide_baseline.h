// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/features/extractor.h"
#include "engram/geometry/stereo_verify.h"
#include "keyframe.h"

#include <memory>
#include <vector>

namespace engram::odometry {

/// Matches two views that are too far apart for tracking: SURF features of the left images, their disparities
/// as those of corners.
class WideBaseline {
 public:
  WideBaseline(const types::StereoModel& model, cv::Mat mask);

  /// By descriptors alone. Fills `features` of the views where it is empty.
  std::vector<geometry::StereoMatch> match(View& a, View& b) const;
  /// Near where the points are expected, V-04.
  std::vector<geometry::StereoMatch> matchNear(View& a, View& b, const Eigen::Isometry3d& T_a_b) const;

 private:
  void describe(View& view) const;
  std::vector<geometry::StereoMatch> toStereo(const View& a, const View& b,
                                              const std::vector<types::Match>& matches) const;

  types::StereoModel model_;
  cv::Mat mask_;
  std::unique_ptr<features::Extractor> extractor_;
};

}  // namespace engram::odometry

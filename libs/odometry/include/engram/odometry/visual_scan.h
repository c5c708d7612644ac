// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/types/features.h"
#include "engram/types/match.h"
#include "engram/types/stereo.h"

#include <Eigen/Geometry>

#include <vector>

namespace engram::odometry {

// Visual scans: features with a 3D position and a descriptor (V: Bertolli, Jensfelt & Christensen 2006,
// sections II.A and II.B). V compares SIFT descriptors of length 512 by squared distance; these limits are
// for descriptors of length 1, and for shares of differing bits where they are binary (V-E2).

/// V-02. When a feature of the left and one of the right image are one point.
struct ScanParams {
  double max_turn = 0.349065850398866;     ///< difference of orientation [rad]
  double max_rows = 1;                     ///< difference of rows that counts as the same row [px] (V-E3)
  double max_stereo_distance = 0.4863;     ///< sqrt(62000) / 512
  double min_depth = 0.2, max_depth = 50;  ///< of the points [m] (V-E3)

  void describe(base::Params& p);
};

/// V-04. When a feature of one scan and one of another are one point.
struct ScanMatchParams {
  /// Directions from the expected one up to which is looked, to each side and up and down [rad] (V-E1).
  double window_width = 0.13962634015954636, window_height = 0.05235987755982988;
  double max_distance = 0.5313;  ///< sqrt(74000) / 512

  void describe(base::Params& p);
};

/// The visual scan of a rectified pair: the features of the left image whose best partner in the same rows of
/// the right one has them as its best partner, with their ranges [m]. Throws std::invalid_argument for
/// descriptors of different kinds.
types::Features makeScan(const types::Features& left, const types::Features& right,
                         const types::StereoModel& model, const ScanParams& params = {});

/// One-to-one matches of two scans, by rising `a`: for each point of a the best descriptor near where T_a_b,
/// the expected pose of the left eye of b in that of a, puts it in the image of b, and the other way round.
/// No test of the ratio: the window is small. Features of a without a range are left out. Throws
/// std::invalid_argument for descriptors of different kinds.
std::vector<types::Match> matchScans(const types::Features& a, const types::Features& b,
                                     const Eigen::Isometry3d& T_a_b, const types::StereoModel& model,
                                     const ScanMatchParams& params = {});

}  // namespace engram::odometry

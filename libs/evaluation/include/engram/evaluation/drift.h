// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/trajectory.h"

#include <optional>
#include <span>
#include <vector>

namespace engram::evaluation {

/// Errors of odometry over stretches of the true path of one length.
struct StretchError {
  double length = 0;       ///< [m]
  int stretches = 0;       ///< measured
  double translation = 0;  ///< mean error at the end of a stretch, as a share of its length
  double rotation = 0;     ///< the same [rad/m]
};

/// How odometry drifts: the relative errors of the KITTI benchmark (Geiger et al., CVPR 2012), over lengths
/// of one's own choice.
struct Drift {
  std::vector<StretchError> byLength;  ///< only lengths that were measured
  StretchError all;                    ///< over all stretches; its `length` is the whole true path

  bool measured() const { return all.stretches > 0; }
};

/// From every pose of a piece to the first one that lies `length` further along the true path. An estimate in
/// several pieces has gaps that no stretch crosses. Poses without truth are left out (see poseAt()).
Drift drift(std::span<const Trajectory> pieces, std::span<const StampedPose> truth,
            std::span<const double> lengths, double maxGap = 1.0);

/// The body of a true trajectory (markers, an inertial unit) is often turned against that of the estimate by
/// some constant, badly known angle, which would count as an error of every stretch. This is the rotation
/// R_truth_body that suits the directions of all motions from pose to pose best (least squares; their lever
/// arms are neglected). None when nearly all go the same way, as those of a car do, which leaves it open.
std::optional<Eigen::Matrix3d> fitBody(std::span<const Trajectory> pieces, std::span<const StampedPose> truth,
                                       double maxGap = 1.0);

/// A trajectory of another body, turned by R_body_other against the first one.
Trajectory turnBody(std::span<const StampedPose> trajectory, const Eigen::Matrix3d& R_body_other);

}  // namespace engram::evaluation

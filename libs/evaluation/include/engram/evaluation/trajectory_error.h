// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/score.h"
#include "engram/evaluation/trajectory.h"

#include <optional>
#include <span>

namespace engram::evaluation {

/// What is free when an estimated trajectory is laid on the true one.
enum class Alignment : std::uint8_t {
  kNone,
  kSe2,   ///< rotation about z and translation: planar robots
  kSe3,   ///< rotation and translation
  kSim3,  ///< scale too: monocular maps
};

/// Absolute trajectory error: distances of positions after alignment.
struct AbsoluteError {
  double rmse = 0.0;     ///< [m]
  Percentiles distance;  ///< [m]
  double scale = 1.0;    ///< applied to the estimate; 1 but for kSim3
  Eigen::Isometry3d T_truth_estimate = Eigen::Isometry3d::Identity();
};

/// Truth is interpolated at the stamps of the estimate (see poseAt()); poses without truth are left out.
/// Least squares by Umeyama 1991. None when no pose has truth.
std::optional<AbsoluteError> ate(std::span<const StampedPose> estimate, std::span<const StampedPose> truth,
                                 Alignment alignment = Alignment::kSe3, double maxGap = 1.0);

/// Relative pose error over `step` poses: does not depend on an alignment.
struct RelativeError {
  double translationRmse = 0.0;  ///< [m]
  double rotationRmse = 0.0;     ///< [rad]
  Percentiles translation;       ///< [m]
  Percentiles rotation;          ///< [rad]
};
std::optional<RelativeError> rpe(std::span<const StampedPose> estimate, std::span<const StampedPose> truth,
                                 int step = 1, double maxGap = 1.0);

}  // namespace engram::evaluation

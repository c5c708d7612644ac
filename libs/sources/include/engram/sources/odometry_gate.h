// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/odometry_track.h"

namespace engram::sources {

/// Whether a robot on Earth can have a reading of odometry. It is judged by itself, not by the ones before:
/// so a recording, which holds poses at the stamps of images, passes exactly when its readings did.
enum class PoseVerdict {
  kPass,
  kNotFinite,  ///< not a number
  kWild,       ///< further away or turned more often than any robot: more than 2e7 m or 1e6 rad
};
PoseVerdict judgePose(const Pose2& pose);

/// The same for the motion between two actions, of 10 km or less.
PoseVerdict judgeStep(const Pose2& step);

}  // namespace engram::sources

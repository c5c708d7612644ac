// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/stereo_rig.h"
#include "ros_messages.h"

namespace engram::bags {

/// The camera of a `camera_info`, on a robot's default mount.
/// @param rectified the images are rectified: `P` without distortion holds, else `K` and `D`.
/// Throws base::Error that says why it cannot be used.
cameras::CameraRig toRig(const RosCameraInfo& info, bool rectified);

/// Where the right camera is, seen from the left one; none when neither `P` of the right one tells.
std::optional<Eigen::Isometry3d> leftToRight(const RosCameraInfo& left, const RosCameraInfo& right,
                                             bool rectified);

}  // namespace engram::bags

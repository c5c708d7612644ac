// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/stereo_rig.h"

#include <optional>
#include <string>

namespace engram::apps {

/// The calibration of a stereo camera as other data sets bring it: `cam0.yaml,cam1.yaml` of EuRoC (the body
/// is the robot), or `calib.txt` of KITTI's odometry benchmark (the first two projections; the left camera is
/// the robot). None when the text is neither.
/// @param imageSize which KITTI's file does not tell.
/// Throws base::Error for such a file that cannot be used.
std::optional<cameras::StereoRig> importStereoRig(const std::string& files, cv::Size imageSize);

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/stereo_rig.h"

#include <opencv2/core/types.hpp>

#include <optional>
#include <string>

namespace engram::cameras {

/// Whether a name is that of another program's calibration (.yaml, .yml, .xml, .txt). loadCamera(),
/// loadStereoRig() and describesStereo() read these too, where the file tells the size of the images.
bool isForeignCalibration(const std::string& files);

/// Calibrations of others, told by what is in them:
/// - YAML or XML of OpenCV: `camera_matrix`, `distortion_coefficients`, `image_width`, `image_height`; with
/// `xi`
///   (module ccalib) it is a unified sphere;
/// - YAML of ROS `camera_info`, as the calibrator writes it or as it is echoed (`K`, `D`, `width`, `height`);
/// - `sensor.yaml` of EuRoC: the body is the robot;
/// - `calib.txt` of KITTI: P0 (P1 is the right eye), or `calib.txt:P2` (P3). Of one camera the mount is the
/// default;
///   of both the left camera is the robot, as in its truth.
/// Two files of two cameras are joined by a comma, `left.yaml,right.yaml`; the second is looked for beside
/// the first.
/// @param imageSize for KITTI, whose files do not tell it.
/// Throws base::ConfigError that names file and key, also for a distortion that Engram's cameras do not have.
CameraRig importCamera(const std::string& files, cv::Size imageSize = {});
/// None when the files describe one camera.
std::optional<StereoRig> importStereoRig(const std::string& files, cv::Size imageSize = {});

}  // namespace engram::cameras

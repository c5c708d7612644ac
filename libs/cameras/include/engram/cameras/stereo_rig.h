// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera_rig.h"

#include <Eigen/Geometry>

#include <string>

namespace engram::cameras {

/// Two cameras on a robot that take their pictures at the same time.
struct StereoRig {
  CameraRig left, right;

  /// Where the right camera is, seen from the left one (x right, y down, z forward).
  Eigen::Isometry3d T_left_right() const { return left.T_robot_cam.inverse() * right.T_robot_cam; }
};

/// Reads the calibration of a stereo camera: either the calibration file of the left camera with the sections
/// [right], [right_mask] and [right_pose] of the right one, or the file of MRPT's `TStereoCamera` (sections
/// `…_LEFT`, `…_RIGHT`, `…_LEFT2RIGHT_POSE`, in which [mount] may stand too).
/// Throws base::ConfigError that names file, line and key; it says so when the file describes one camera
/// only.
StereoRig loadStereoRig(const std::string& path);

/// Whether a calibration file is one of these. Throws base::ConfigError when it cannot be read.
bool describesStereo(const std::string& path);

/// The same as loadStereoRig() from a text; `name` stands for the file in messages.
StereoRig parseStereoRig(const std::string& text, const std::string& name);

/// The calibration file of a rig, of the first of these two kinds. parseCamera() reads its left camera.
std::string toText(const StereoRig& rig);

/// The file of MRPT's `TStereoCamera`, with [mount] behind it. Throws base::Error for cameras that it cannot
/// describe: it knows pinholes without skew.
std::string toMrptText(const StereoRig& rig);

}  // namespace engram::cameras

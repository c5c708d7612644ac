// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/cameras/camera.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <memory>
#include <string>

namespace engram::cameras {

/// Which part of the image shows the world (F-09): section [mask]. Zero means no limit.
struct MaskParams {
  double inner_radius = 0;  ///< [px] about (cx, cy): the robot itself; unified_sphere and pinhole
  double outer_radius = 0;  ///< [px] about (cx, cy): the rim of the mirror; unified_sphere and pinhole
  int top_rows = 0;         ///< [px] cut off at the top; equirectangular
  int bottom_rows = 0;      ///< [px] cut off at the bottom; equirectangular
  std::string file;         ///< image of the same size, non-zero = use; relative to the calibration file
};

/// A camera on a robot.
struct CameraRig {
  std::shared_ptr<const Camera> camera;
  cv::Mat mask;  ///< CV_8U of the image's size, 255 = use, 0 = ignore; never empty
  Eigen::Isometry3d T_robot_cam = Eigen::Isometry3d::Identity();
  MaskParams maskParams;  ///< what `mask` was made of
};

/// How a camera of this model sits on a robot when nobody says otherwise: `pinhole` and `equirectangular`
/// look forward (z forward, x right, y down); `unified_sphere` looks down, with the robot in the middle of
/// the image and forward at its top (z down, x right, y backward), as a camera below a mirror does.
Eigen::Isometry3d defaultMount(const std::string& model);

/// Rig of a camera without calibration file: default mount, everything visible.
CameraRig makeRig(std::shared_ptr<const Camera> camera);

/// Reads a calibration file: sections [camera], [mask], [mount]. Unknown, missing and impossible values throw
/// base::ConfigError with file, line and key.
CameraRig loadCamera(const std::string& path);

/// The same from a text; `name` stands for the file in messages, and its folder is where a mask image is
/// looked for.
CameraRig parseCamera(const std::string& text, const std::string& name);

/// The calibration file of a rig. Equal rigs give equal texts; a mask image is mentioned, not contained.
std::string toText(const CameraRig& rig);

/// Writes toText(rig). A mask that came from an image is written beside it as `<stem>_mask.png`.
void saveCamera(const CameraRig& rig, const std::string& path);

}  // namespace engram::cameras

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration_text.h"
#include "engram/base/config.h"
#include "engram/cameras/camera_rig.h"

#include <string>

namespace engram::cameras {

/// A pose as three distances and three angles: the section [mount].
struct MountParams {
  double x = 0, y = 0, z = 0;           // [m]
  double yaw = 0, pitch = 0, roll = 0;  // [rad]
  bool onRobot = true;                  // else in the frame of the left camera

  void describe(base::Params& p);
  Eigen::Isometry3d pose() const;
  static MountParams of(const Eigen::Isometry3d& T);
};

/// What the sections of one camera are called.
struct RigSections {
  std::string camera = "camera", mask = "mask", mount = "mount";
};

/// Of the right camera in the file of a stereo camera.
inline const RigSections kRightSections{"right", "right_mask", "right_pose"};

/// The calibration file of one camera, or one camera's part of it.
class RigText {
 public:
  /// Throws base::ConfigError when the model or a key that it needs is missing.
  /// @param onRobot whether the mount is on the robot, where it has a default, or in the left camera's frame.
  RigText(const base::IniFile& ini, const RigSections& sections = {}, bool onRobot = true);

  /// Must be called before `config` reads the file; this object must stay where it is until then.
  void bind(base::Config& config);
  /// To be called after it. The pose of the rig is that of the section for the mount.
  CameraRig rig() const;

 private:
  std::string name_;
  RigSections sections_;
  CalibrationText calibration_;
  MaskParams mask_;
  MountParams mount_;
};

/// The sections of one camera, readable by RigText. The pose is `rig.T_robot_cam`.
std::string toText(const CameraRig& rig, const RigSections& sections, bool onRobot);

/// Reads a whole file. Throws base::ConfigError.
std::string readCalibrationFile(const std::string& path);

}  // namespace engram::cameras

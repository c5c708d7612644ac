// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/stereo_rig.h"

#include "engram/base/error.h"
#include "engram/cameras/camera_import.h"
#include "mrpt_stereo.h"
#include "rig_text.h"

namespace engram::cameras {

StereoRig parseStereoRig(const std::string& text, const std::string& name) {
  const base::IniFile ini = base::IniFile::parse(text, name);
  if (isMrptStereo(ini)) return readMrptStereo(ini);
  RigText left(ini);
  if (!ini.sections().contains(kRightSections.camera))
    throw base::ConfigError(name + ": describes one camera; a stereo camera has the sections [right] and " +
                            "[right_pose] too (engram-rawlog calibrate --stereo writes them)");
  if (!ini.sections().contains(kRightSections.mount))
    throw base::ConfigError(name + ": no section [" + kRightSections.mount +
                            "], which says where the right camera is, seen from the left one");
  RigText right(ini, kRightSections, false);
  base::Config config;
  left.bind(config);
  right.bind(config);
  config.read(ini);
  StereoRig rig{left.rig(), right.rig()};
  rig.right.T_robot_cam = rig.left.T_robot_cam * rig.right.T_robot_cam;
  return rig;
}

StereoRig loadStereoRig(const std::string& path) {
  if (!isForeignCalibration(path)) return parseStereoRig(readCalibrationFile(path), path);
  auto rig = importStereoRig(path);
  if (!rig) throw base::ConfigError(path + ": describes one camera; give both, as left.yaml,right.yaml");
  return *std::move(rig);
}

bool describesStereo(const std::string& path) {
  if (isForeignCalibration(path)) return importStereoRig(path).has_value();
  const base::IniFile ini = base::IniFile::load(path);
  return isMrptStereo(ini) || ini.sections().contains(kRightSections.camera);
}

std::string toText(const StereoRig& rig) {
  CameraRig right = rig.right;
  right.T_robot_cam = rig.T_left_right();
  return toText(rig.left) + toText(right, kRightSections, false);
}

std::string toMrptText(const StereoRig& rig) { return mrptStereoText(rig); }

}  // namespace engram::cameras

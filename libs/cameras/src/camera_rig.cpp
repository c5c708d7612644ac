// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/camera_rig.h"

#include "engram/base/atomic_file.h"
#include "engram/cameras/camera_import.h"
#include "mrpt_stereo.h"
#include "rig_text.h"

#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <numbers>
#include <optional>
#include <vector>

namespace engram::cameras {

Eigen::Isometry3d defaultMount(const std::string& model) {
  const double quarter = 0.5 * std::numbers::pi;
  const bool down = model == "unified_sphere";
  Eigen::Isometry3d T = MountParams{.yaw = -quarter, .roll = down ? 2 * quarter : -quarter}.pose();
  T.linear() = T.linear().array().round().matrix();  // exact zeros and ones
  return T;
}

CameraRig makeRig(std::shared_ptr<const Camera> camera) {
  const cv::Mat mask(camera->imageSize(), CV_8U, cv::Scalar(255));
  const Eigen::Isometry3d T_robot_cam = defaultMount(camera->model());
  return {std::move(camera), mask, T_robot_cam, {}};
}

CameraRig parseCamera(const std::string& text, const std::string& name) {
  const base::IniFile ini = base::IniFile::parse(text, name);
  if (isMrptStereo(ini)) return readMrptStereo(ini).left;
  if (auto rig = readMrptCamera(ini)) return *std::move(rig);
  base::Config config;
  RigText camera(ini);
  camera.bind(config);
  std::optional<RigText> right;  // of a stereo camera, whose left one is read here
  if (ini.sections().contains(kRightSections.camera)) right.emplace(ini, kRightSections, false).bind(config);
  config.read(ini);
  return camera.rig();
}

CameraRig loadCamera(const std::string& path) {
  return isForeignCalibration(path) ? importCamera(path) : parseCamera(readCalibrationFile(path), path);
}

std::string toText(const CameraRig& rig) { return toText(rig, RigSections{}, true); }

void saveCamera(const CameraRig& rig, const std::string& path) {
  CameraRig copy = rig;
  const std::filesystem::path file(path);
  if (!rig.maskParams.file.empty()) {
    copy.maskParams.file = file.stem().string() + "_mask.png";
    if (!base::isRegularOutput(path))
      throw base::Error(path + ": the mask '" + rig.maskParams.file + "' is to lie beside the calibration");
    std::vector<unsigned char> png;
    cv::imencode(".png", rig.mask, png);
    base::writeText((file.parent_path() / copy.maskParams.file).string(),
                    {reinterpret_cast<const char*>(png.data()), png.size()}, true);
  }
  base::writeText(path, toText(copy), true);
}

}  // namespace engram::cameras

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/camera_rig.h"

#include "calibration_text.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/unified_sphere.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

namespace engram::cameras {
namespace {

const std::vector<std::string> kModels{"unified_sphere", "pinhole", "equirectangular"};
constexpr int kMaxPixels = 32768;  // a side

struct MountParams {
  double x = 0, y = 0, z = 0;           // [m]
  double yaw = 0, pitch = 0, roll = 0;  // [rad]

  void describe(base::Params& p) {
    p.add("x", x, "position on the robot, forward [m]");
    p.add("y", y, "position on the robot, left [m]");
    p.add("z", z, "position on the robot, up [m]");
    const std::string about = "R_robot_cam = Rz(yaw) Ry(pitch) Rx(roll), as MRPT: about ";
    p.addDegrees("yaw", yaw, about + "z [deg]", {-360, 360});
    p.addDegrees("pitch", pitch, about + "y [deg]", {-360, 360});
    p.addDegrees("roll", roll, about + "x [deg]", {-360, 360});
  }

  Eigen::Isometry3d pose() const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = Eigen::Vector3d(x, y, z);
    T.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
    return T;
  }

  static MountParams of(const Eigen::Isometry3d& T) {
    const Eigen::Matrix3d R = T.rotation();
    MountParams m{.x = T.translation().x(), .y = T.translation().y(), .z = T.translation().z()};
    const double horizontal = std::hypot(R(0, 0), R(1, 0));
    m.pitch = std::atan2(-R(2, 0), horizontal);
    if (horizontal > 1e-9) {
      m.yaw = std::atan2(R(1, 0), R(0, 0));
      m.roll = std::atan2(R(2, 1), R(2, 2));
    } else {  // gimbal lock: put all of it into roll
      m.roll = std::atan2(-R(1, 2), R(1, 1));
    }
    return m;
  }
};

struct MaskText {
  const std::string& model;
  MaskParams& mask;

  void describe(base::Params& p) {
    if (model == "equirectangular") {
      p.add("top_rows", mask.top_rows, "rows ignored at the top [px]", base::atLeast(0));
      p.add("bottom_rows", mask.bottom_rows, "rows ignored at the bottom [px]", base::atLeast(0));
    } else {
      p.add("inner_radius", mask.inner_radius, "ignored disc about (cx, cy), the robot itself [px]; 0 none",
            base::atLeast(0));
      p.add("outer_radius", mask.outer_radius, "ignored outside this circle about (cx, cy) [px]; 0 none",
            base::atLeast(0));
    }
    p.add("file", mask.file, "mask image, non-zero = use; relative to this file; empty none");
  }
};

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw base::ConfigError(name + ": " + what);
}

const base::IniFile::Section& cameraSection(const base::IniFile& ini) {
  const auto at = ini.sections().find("camera");
  if (at == ini.sections().end()) fail(ini.name(), "no section [camera]; is this a calibration file?");
  return at->second;
}

std::string readModel(const base::IniFile& ini) {
  const auto& section = cameraSection(ini);
  const auto at = section.find("model");
  if (at == section.end())
    fail(ini.name(), "[camera] model is missing: unified_sphere, pinhole or equirectangular");
  if (std::find(kModels.begin(), kModels.end(), at->second.text) == kModels.end())
    fail(at->second.origin,
         "[camera] model: '" + at->second.text + "' is not one of unified_sphere, pinhole, equirectangular");
  return at->second.text;
}

void requireKeys(const base::IniFile& ini, const CalibrationText& text) {
  const auto& section = cameraSection(ini);
  std::vector<std::string> keys{"width", "height"};
  if (text.model == "unified_sphere") keys.push_back("xi");
  const bool byAngle = section.contains("fov_deg");
  for (const char* key : {"fx", "fy", "cx", "cy"}) {
    if (byAngle && section.contains(key))
      fail(section.at(key).origin,
           std::string("[camera] ") + key + " and fov_deg exclude each other; remove one");
    if (text.model != "equirectangular" && !byAngle) keys.push_back(key);
  }
  for (const auto& key : keys)
    if (!section.contains(key)) fail(ini.name(), "[camera] " + key + " is missing");
}

std::shared_ptr<const Camera> makeCamera(const CalibrationText& text) {
  const cv::Size size(text.width, text.height);
  if (text.model == "equirectangular") return std::make_shared<Equirectangular>(size);
  if (text.model == "unified_sphere") return std::make_shared<UnifiedSphere>(size, text.xi, text.plane);
  if (text.fov_deg == 0) return std::make_shared<Pinhole>(size, text.plane);
  const auto ideal = approximatePinhole(size, text.fov_deg * std::numbers::pi / 180);
  ImagePlaneParams plane = static_cast<const Pinhole&>(*ideal).plane();
  plane.skew = text.plane.skew;
  plane.k1 = text.plane.k1, plane.k2 = text.plane.k2, plane.k3 = text.plane.k3;
  plane.p1 = text.plane.p1, plane.p2 = text.plane.p2;
  return std::make_shared<Pinhole>(size, plane);
}

ImagePlaneParams planeOf(const Camera& camera) {
  if (const auto* sphere = dynamic_cast<const UnifiedSphere*>(&camera)) return sphere->plane();
  if (const auto* pinhole = dynamic_cast<const Pinhole*>(&camera)) return pinhole->plane();
  return {};
}

cv::Mat drawMask(const Camera& camera, const MaskParams& p, const std::string& name) {
  const cv::Size size = camera.imageSize();
  const ImagePlaneParams plane = planeOf(camera);
  cv::Mat mask(size, CV_8U, cv::Scalar(255));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double r = std::hypot(x - plane.cx, y - plane.cy);
      const bool inside = r >= p.inner_radius && (p.outer_radius == 0 || r <= p.outer_radius) &&
                          y >= p.top_rows && y < size.height - p.bottom_rows;
      if (!inside) mask.at<std::uint8_t>(y, x) = 0;
    }
  if (p.file.empty()) return mask;
  const auto path = (std::filesystem::path(name).parent_path() / p.file).string();
  // Asked first because OpenCV prints a warning about a missing file.
  const cv::Mat image = std::filesystem::exists(path) ? cv::imread(path, cv::IMREAD_GRAYSCALE) : cv::Mat();
  if (image.empty()) fail(name, "[mask] file: '" + path + "' is not an image that can be read");
  if (image.size() != size)
    fail(name, "[mask] file: '" + path + "' has " + std::to_string(image.cols) + "x" +
                   std::to_string(image.rows) + " pixels, the camera " + std::to_string(size.width) + "x" +
                   std::to_string(size.height));
  mask.setTo(0, image == 0);
  return mask;
}

}  // namespace

void CalibrationText::describe(base::Params& p) {
  p.addChoice("model", model, "camera model", kModels);
  p.add("width", width, "image width [px]", {1, kMaxPixels});
  p.add("height", height, "image height [px]", {1, kMaxPixels});
  if (model == "equirectangular") return;
  if (model == "unified_sphere") p.add("xi", xi, "mirror parameter of the unified sphere model", {0, 100});
  if (model == "pinhole" && reading)
    p.add("fov_deg", fov_deg, "horizontal field of view of an uncalibrated camera [deg]", {1, 179});
  p.add("fx", plane.fx, "focal length [px]; negative when the image is mirrored left to right");
  p.add("fy", plane.fy, "focal length [px]; negative when the image is mirrored top to bottom");
  p.add("cx", plane.cx, "principal point [px]; the centre of the top left pixel is 0");
  p.add("cy", plane.cy, "principal point [px]");
  p.add("skew", plane.skew, "skew [px]: u = fx x + skew y + cx");
  p.add("k1", plane.k1, "radial distortion, r^2");
  p.add("k2", plane.k2, "radial distortion, r^4");
  p.add("p1", plane.p1, "tangential distortion");
  p.add("p2", plane.p2, "tangential distortion");
  p.add("k3", plane.k3, "radial distortion, r^6");
}

std::string CalibrationText::dump() {
  base::Config config;
  config.bind("camera", *this);
  return config.dump();
}

void checkSize(cv::Size size) {
  if (size.width < 1 || size.height < 1 || size.width > kMaxPixels || size.height > kMaxPixels)
    throw base::Error("camera: an image of " + std::to_string(size.width) + "x" +
                      std::to_string(size.height) + " pixels; each side must be in [1, " +
                      std::to_string(kMaxPixels) + "]");
}

cv::Size scaledSize(cv::Size size, double factorX, double factorY) {
  return {static_cast<int>(std::lround(size.width * factorX)),
          static_cast<int>(std::lround(size.height * factorY))};
}

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
  CalibrationText calibration{.model = readModel(ini), .reading = true};
  requireKeys(ini, calibration);
  CameraRig rig;
  MaskText mask{calibration.model, rig.maskParams};
  MountParams mount = MountParams::of(defaultMount(calibration.model));
  base::Config config;
  config.bind("camera", calibration);
  config.bind("mask", mask);
  config.bind("mount", mount);
  config.read(ini);
  try {
    rig.camera = makeCamera(calibration);
  } catch (const base::ConfigError&) {
    throw;
  } catch (const base::Error& e) {
    fail(name, "[camera] " + std::string(e.what()));
  }
  const MaskParams& m = rig.maskParams;
  if (m.outer_radius != 0 && m.inner_radius >= m.outer_radius)
    fail(name, "[mask] inner_radius must be smaller than outer_radius");
  if (m.top_rows + m.bottom_rows >= calibration.height)
    fail(name, "[mask] top_rows and bottom_rows leave no image");
  rig.mask = drawMask(*rig.camera, m, name);
  if (cv::countNonZero(rig.mask) == 0) fail(name, "[mask] leaves no pixel to see with");
  rig.T_robot_cam = mount.pose();
  return rig;
}

CameraRig loadCamera(const std::string& path) {
  std::ifstream in(path);
  if (!in) fail(path, "cannot be opened; does the file exist and may you read it?");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parseCamera(text, path);
}

std::string toText(const CameraRig& rig) {
  const std::string model = rig.camera->model();
  MaskParams params = rig.maskParams;
  MaskText mask{model, params};
  MountParams mount = MountParams::of(rig.T_robot_cam);
  base::Config config;
  config.bind("mask", mask);
  config.bind("mount", mount);
  return rig.camera->toText() + config.dump();
}

void saveCamera(const CameraRig& rig, const std::string& path) {
  CameraRig copy = rig;
  const std::filesystem::path file(path);
  if (!rig.maskParams.file.empty()) {
    copy.maskParams.file = file.stem().string() + "_mask.png";
    const std::string image = (file.parent_path() / copy.maskParams.file).string();
    if (!cv::imwrite(image, rig.mask))
      fail(image, "cannot be written; does the folder exist and may you write to it?");
  }
  std::ofstream out(path);
  out << toText(copy);
  out.close();
  if (!out) fail(path, "cannot be written; does the folder exist and may you write to it?");
}

}  // namespace engram::cameras

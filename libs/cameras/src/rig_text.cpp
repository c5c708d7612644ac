// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rig_text.h"

#include "engram/base/error.h"
#include "engram/base/image_header.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"
#include "engram/cameras/equirectangular.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/unified_sphere.h"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

namespace engram::cameras {
namespace {

const std::vector<std::string> kModels{"unified_sphere", "pinhole", "equirectangular"};

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

const base::IniFile::Section& cameraSection(const base::IniFile& ini, const std::string& name) {
  const auto at = ini.sections().find(name);
  if (at == ini.sections().end()) fail(ini.name(), "no section [" + name + "]; is this a calibration file?");
  return at->second;
}

std::string readModel(const base::IniFile& ini, const std::string& name) {
  const auto& section = cameraSection(ini, name);
  const auto at = section.find("model");
  const std::string key = "[" + name + "] model";
  if (at == section.end()) fail(ini.name(), key + " is missing: unified_sphere, pinhole or equirectangular");
  if (std::find(kModels.begin(), kModels.end(), at->second.text) == kModels.end())
    fail(at->second.origin, key + ": " + base::quoted(at->second.text) +
                                " is not one of unified_sphere, pinhole, equirectangular");
  return at->second.text;
}

void requireKeys(const base::IniFile& ini, const std::string& name, const CalibrationText& text) {
  const auto& section = cameraSection(ini, name);
  std::vector<std::string> keys{"width", "height"};
  if (text.model == "unified_sphere") keys.push_back("xi");
  const bool byAngle = section.contains("fov_deg");
  for (const char* key : {"fx", "fy", "cx", "cy"}) {
    if (byAngle && section.contains(key))
      fail(section.at(key).origin, "[" + name + "] " + key + " and fov_deg exclude each other; remove one");
    if (text.model != "equirectangular" && !byAngle) keys.push_back(key);
  }
  for (const auto& key : keys)
    if (!section.contains(key)) fail(ini.name(), "[" + name + "] " + key + " is missing");
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

cv::Mat readMask(const std::string& path, const std::string& origin) {
  cv::Mat image;
  try {
    image = cv::imdecode(base::readImageBytes(path), cv::IMREAD_GRAYSCALE);
  } catch (const base::Error& e) {
    fail(origin, e.what());
  }
  if (image.empty()) fail(origin, base::quoted(path) + " is not an image that can be read");
  return image;
}

cv::Mat drawMask(const Camera& camera, const MaskParams& p, const std::string& name,
                 const std::string& section) {
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
  const cv::Mat image = readMask(path, name + ": " + section + " file");
  if (image.size() != size)
    fail(name, section + " file: " + base::quoted(path) + " has " + std::to_string(image.cols) + "x" +
                   std::to_string(image.rows) + " pixels, the camera " + std::to_string(size.width) + "x" +
                   std::to_string(size.height));
  mask.setTo(0, image == 0);
  return mask;
}

}  // namespace

void MountParams::describe(base::Params& p) {
  const std::string where = onRobot ? "position on the robot, " : "position seen from the left camera, ";
  p.add("x", x, where + (onRobot ? "forward [m]" : "right [m]"));
  p.add("y", y, where + (onRobot ? "left [m]" : "down [m]"));
  p.add("z", z, where + (onRobot ? "up [m]" : "forward [m]"));
  const std::string about = std::string(onRobot ? "R_robot_cam" : "R_left_right") +
                            " = Rz(yaw) Ry(pitch) Rx(roll), as MRPT: about ";
  p.addDegrees("yaw", yaw, about + "z [deg]", {-360, 360});
  p.addDegrees("pitch", pitch, about + "y [deg]", {-360, 360});
  p.addDegrees("roll", roll, about + "x [deg]", {-360, 360});
}

Eigen::Isometry3d MountParams::pose() const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(x, y, z);
  T.linear() =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return T;
}

MountParams MountParams::of(const Eigen::Isometry3d& T) {
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

void CalibrationText::describe(base::Params& p) {
  p.addChoice("model", model, "camera model", kModels);
  p.add("width", width, "image width [px]", {1, base::kMaxImageSide});
  p.add("height", height, "image height [px]", {1, base::kMaxImageSide});
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

RigText::RigText(const base::IniFile& ini, const RigSections& sections, bool onRobot)
    : name_(ini.name()),
      sections_(sections),
      calibration_{.model = readModel(ini, sections.camera), .reading = true} {
  requireKeys(ini, sections.camera, calibration_);
  if (onRobot) mount_ = MountParams::of(defaultMount(calibration_.model));
  mount_.onRobot = onRobot;
}

void RigText::bind(base::Config& config) {
  MaskText mask{calibration_.model, mask_};
  config.bind(sections_.camera, calibration_);
  config.bind(sections_.mask, mask);
  config.bind(sections_.mount, mount_);
}

CameraRig RigText::rig() const {
  CameraRig rig;
  const std::string section = "[" + sections_.mask + "]";
  try {
    rig.camera = makeCamera(calibration_);
  } catch (const base::ConfigError&) {
    throw;
  } catch (const base::Error& e) {
    fail(name_, "[" + sections_.camera + "] " + e.what());
  }
  if (mask_.outer_radius != 0 && mask_.inner_radius >= mask_.outer_radius)
    fail(name_, section + " inner_radius must be smaller than outer_radius");
  if (mask_.top_rows + mask_.bottom_rows >= calibration_.height)
    fail(name_, section + " top_rows and bottom_rows leave no image");
  rig.maskParams = mask_;
  rig.mask = drawMask(*rig.camera, mask_, name_, section);
  if (cv::countNonZero(rig.mask) == 0) fail(name_, section + " leaves no pixel to see with");
  rig.T_robot_cam = mount_.pose();
  return rig;
}

std::string toText(const CameraRig& rig, const RigSections& sections, bool onRobot) {
  const std::string model = rig.camera->model(), camera = rig.camera->toText();
  MaskParams params = rig.maskParams;
  MaskText mask{model, params};
  MountParams mount = MountParams::of(rig.T_robot_cam);
  mount.onRobot = onRobot;
  base::Config config;
  config.bind(sections.mask, mask);
  config.bind(sections.mount, mount);
  return "[" + sections.camera + "]" + camera.substr(camera.find('\n')) + config.dump();
}

std::string readCalibrationFile(const std::string& path) {
  try {
    return base::readTextFile(path);
  } catch (const base::Error& e) {
    throw base::ConfigError(e.what());
  }
}

void checkSize(cv::Size size) {
  if (!base::plausibleSize(size.width, size.height))
    throw base::Error("camera: width x height = " + base::sizeRefusal(size.width, size.height));
}

cv::Size scaledSize(cv::Size size, double factorX, double factorY) {
  return {static_cast<int>(std::lround(size.width * factorX)),
          static_cast<int>(std::lround(size.height * factorY))};
}

}  // namespace engram::cameras

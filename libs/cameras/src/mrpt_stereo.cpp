// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mrpt_stereo.h"

#include "engram/base/error.h"
#include "engram/base/image_header.h"
#include "engram/base/text.h"
#include "engram/cameras/pinhole.h"
#include "rig_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

namespace engram::cameras {
namespace {

const std::string kPoseSuffix = "_LEFT2RIGHT_POSE";

[[noreturn]] void fail(const std::string& origin, const std::string& what) {
  throw base::ConfigError(origin + ": " + what);
}

/// One section of the file, and what is read from it.
class Section {
 public:
  Section(const base::IniFile& ini, const std::string& name) : name_(name) {
    const auto at = ini.sections().find(name);
    if (at == ini.sections().end()) fail(ini.name(), "no section [" + name + "]");
    values_ = &at->second;
    file_ = ini.name();
  }

  const base::IniFile::Value* find(const std::string& key) const {
    const auto at = values_->find(key);
    return at == values_->end() ? nullptr : &at->second;
  }
  /// The numbers of `[1 2 3]`, or of a single one.
  std::vector<double> numbers(const std::string& key) const {
    const auto* value = find(key);
    if (!value) fail(file_, "[" + name_ + "] " + key + " is missing");
    std::string text = value->text;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
    std::istringstream in(text);
    std::vector<double> numbers;
    for (std::string word; in >> word;) {
      double number = 0;
      const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (status != std::errc() || end != word.data() + word.size() || !std::isfinite(number))
        refuse(key, base::quoted(word) + " is not a number");
      numbers.push_back(number);
    }
    return numbers;
  }
  double number(const std::string& key) const {
    const auto list = numbers(key);
    if (list.size() != 1) refuse(key, "expected one number");
    return list[0];
  }
  [[noreturn]] void refuse(const std::string& key, const std::string& what) const {
    const auto* value = find(key);
    fail(value ? value->origin : file_, "[" + name_ + "] " + key + ": " + what);
  }

 private:
  std::string file_, name_;
  const base::IniFile::Section* values_;
};

void readDistortion(const Section& section, ImagePlaneParams& plane) {
  const auto* model = section.find("distortion_model");
  const std::string name = model ? model->text : section.find("dist") ? "plumb_bob" : "none";
  if (name == "none") return;
  if (name != "plumb_bob")
    section.refuse("distortion_model", base::quoted(name) + " is not supported; use plumb_bob or none");
  const auto dist = section.numbers("dist");
  if (dist.size() != 4 && dist.size() != 5 && dist.size() != 8)
    section.refuse("dist", "expected [k1 k2 p1 p2 k3]");
  if (std::any_of(dist.begin() + std::min<std::ptrdiff_t>(5, std::ssize(dist)), dist.end(),
                  [](double k) { return k != 0; }))
    section.refuse("dist", "k4, k5 and k6 are not supported; calibrate with five coefficients");
  plane.k1 = dist[0], plane.k2 = dist[1], plane.p1 = dist[2], plane.p2 = dist[3];
  plane.k3 = dist.size() > 4 ? dist[4] : 0;
}

CameraRig readCamera(const Section& section) {
  const auto resolution = section.numbers("resolution");
  if (resolution.size() != 2) section.refuse("resolution", "expected [width height]");
  const auto whole = [](double n) { return n == std::floor(n) && n >= 1 && n <= base::kMaxImageSide; };
  if (!whole(resolution[0]) || !whole(resolution[1]))
    section.refuse("resolution", "expected whole numbers of 1 to " + std::to_string(base::kMaxImageSide));
  const cv::Size size(static_cast<int>(resolution[0]), static_cast<int>(resolution[1]));
  ImagePlaneParams plane;
  plane.fx = section.number("fx"), plane.fy = section.number("fy");
  plane.cx = section.number("cx"), plane.cy = section.number("cy");
  for (double* value : {&plane.fx, &plane.cx})  // MRPT takes small numbers for shares of the image
    if (*value < 2) *value *= size.width;
  for (double* value : {&plane.fy, &plane.cy})
    if (*value < 2) *value *= size.height;
  readDistortion(section, plane);
  try {
    return makeRig(std::make_shared<Pinhole>(size, plane));
  } catch (const base::Error& e) {
    section.refuse("resolution", e.what());
  }
}

Eigen::Isometry3d readPose(const Section& section) {
  const std::string key = "pose_quaternion";
  const auto v = section.numbers(key);
  if (v.size() != 7) section.refuse(key, "expected [x y z qr qx qy qz]");
  const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1) > 1e-3) section.refuse(key, "the quaternion is not of unit length");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return T;
}

/// MRPT's functions may read the file, which ignore what they do not know: so the others are left alone.
Eigen::Isometry3d readMount(const base::IniFile& ini) {
  MountParams mount = MountParams::of(defaultMount("pinhole"));
  const auto at = ini.sections().find("mount");
  if (at == ini.sections().end()) return mount.pose();
  std::string text = "[mount]\n";
  for (const auto& [key, value] : at->second) text += key + " = " + value.text + "\n";
  base::Config config;
  config.bind("mount", mount);
  config.read(base::IniFile::parse(text, ini.name() + " [mount]"));
  return mount.pose();
}

void writeCamera(std::ostream& out, const std::string& section, const CameraRig& rig) {
  const auto* camera = dynamic_cast<const Pinhole*>(rig.camera.get());
  if (!camera || camera->plane().skew != 0)
    throw base::Error("MRPT's file of a stereo camera describes pinholes without skew only");
  const ImagePlaneParams& p = camera->plane();
  const bool none = p.k1 == 0 && p.k2 == 0 && p.k3 == 0 && p.p1 == 0 && p.p2 == 0;
  out << "[" << section << "]\nresolution = [" << camera->imageSize().width << " "
      << camera->imageSize().height << "]\ncx = " << p.cx << "\ncy = " << p.cy << "\nfx = " << p.fx
      << "\nfy = " << p.fy << "\ndistortion_model = " << (none ? "none" : "plumb_bob") << "\ndist = [" << p.k1
      << " " << p.k2 << " " << p.p1 << " " << p.p2 << " " << p.k3 << "]\n\n";
}

}  // namespace

bool isMrptStereo(const base::IniFile& ini) {
  return std::any_of(ini.sections().begin(), ini.sections().end(),
                     [](const auto& section) { return section.first.ends_with(kPoseSuffix); });
}

StereoRig readMrptStereo(const base::IniFile& ini) {
  std::string prefix;
  for (const auto& [name, values] : ini.sections())
    if (name.ends_with(kPoseSuffix)) prefix = name.substr(0, name.size() - kPoseSuffix.size());
  StereoRig rig{readCamera(Section(ini, prefix + "_LEFT")), readCamera(Section(ini, prefix + "_RIGHT"))};
  rig.left.T_robot_cam = readMount(ini);
  rig.right.T_robot_cam = rig.left.T_robot_cam * readPose(Section(ini, prefix + kPoseSuffix));
  return rig;
}

std::optional<CameraRig> readMrptCamera(const base::IniFile& ini) {
  std::vector<std::string> found;
  for (const auto& [name, values] : ini.sections())
    if (values.contains("resolution")) found.push_back(name);
  if (found.size() != 1 || ini.sections().contains("camera")) return std::nullopt;
  CameraRig rig = readCamera(Section(ini, found.front()));
  rig.T_robot_cam = readMount(ini);
  return rig;
}

std::string mrptStereoText(const StereoRig& rig) {
  std::ostringstream out;
  out.precision(17);
  writeCamera(out, "CAMERA_PARAMS_LEFT", rig.left);
  writeCamera(out, "CAMERA_PARAMS_RIGHT", rig.right);
  const Eigen::Isometry3d T = rig.T_left_right();
  const Eigen::Quaterniond q(T.rotation());
  const Eigen::Vector3d t = T.translation();
  out << "[CAMERA_PARAMS" << kPoseSuffix << "]\npose_quaternion = [" << t.x() << " " << t.y() << " " << t.z()
      << " " << q.w() << " " << q.x() << " " << q.y() << " " << q.z() << "]\n\n";
  MountParams mount = MountParams::of(rig.left.T_robot_cam);
  base::Config config;
  config.bind("mount", mount);
  return out.str() + config.dump();
}

}  // namespace engram::cameras

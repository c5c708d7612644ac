// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_calibration.h"

#include "engram/base/image_header.h"
#include "engram/cameras/pinhole.h"
#include "rawlog_stamp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

namespace engram::sources {
namespace {

constexpr std::string_view kQuaternionPose = "CPose3DQuat";

/// Reads values one after another; what is missing or not a number makes it fail for good.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  template <class T>
  T value() {
    T v{};
    if (bytes_.size() < sizeof v) ok_ = false;
    if (!ok_) return v;
    std::memcpy(&v, bytes_.data(), sizeof v);
    skip(sizeof v);
    return v;
  }
  double number() {
    const double v = value<double>();
    ok_ = ok_ && std::isfinite(v);
    return v;
  }
  void skip(std::size_t n) {
    if (n > bytes_.size()) ok_ = false;
    if (ok_) bytes_ = bytes_.subspan(n);
  }
  /// The version of an object of this class; its name may have a name space before it.
  int header(std::string_view name) {
    const std::size_t length = value<std::uint8_t>() & 0x7F;
    if (length > bytes_.size()) ok_ = false;
    if (!ok_) return -1;
    const std::string_view found(reinterpret_cast<const char*>(bytes_.data()), length);
    ok_ = found == name || found.ends_with("::" + std::string(name));
    skip(length);
    return value<std::uint8_t>();
  }
  void end() { ok_ = value<std::uint8_t>() == kEndFlag && ok_; }
  void fail() { ok_ = false; }

 private:
  std::span<const std::uint8_t> bytes_;
  bool ok_ = true;
};

Eigen::Isometry3d makePose(const Eigen::Vector3d& t, const Eigen::Matrix3d& R) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = t;
  return T;
}

Eigen::Vector3d readVector(Cursor& in) {
  const double x = in.number(), y = in.number(), z = in.number();
  return {x, y, z};
}

Eigen::Isometry3d readQuaternionPose(Cursor& in) {
  const Eigen::Vector3d t = readVector(in);
  const double w = in.number(), x = in.number(), y = in.number(), z = in.number();
  const Eigen::Quaterniond q(w, x, y, z);
  if (!in.ok() || std::abs(q.norm() - 1) > 1e-3) {
    in.fail();
    return Eigen::Isometry3d::Identity();
  }
  return makePose(t, q.normalized().toRotationMatrix());
}

Eigen::Isometry3d readPose3D(Cursor& in) {
  const int version = in.header("CPose3D");
  if (version == 2) return readQuaternionPose(in);
  if (version != 3) in.fail();
  const Eigen::Vector3d t = readVector(in);
  Eigen::Matrix3d R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) R(r, c) = in.number();
  if (!in.ok() || !(R * R.transpose()).isIdentity(1e-3)) in.fail();
  return makePose(t, R);
}

/// TCamera of MRPT 1.4 and later: versions 4 to 6.
RecordedCamera readCamera(Cursor& in) {
  RecordedCamera camera;
  const int version = in.header("TCamera");
  if (version < 4 || version > 6) in.fail();
  in.number();  // focal length [m]
  std::array<double, 8> dist{};
  for (double& k : dist) k = in.number();
  auto& p = camera.plane;
  p.fx = in.number(), p.fy = in.number(), p.cx = in.number(), p.cy = in.number();
  camera.size.height = static_cast<int>(in.value<std::uint32_t>());
  camera.size.width = static_cast<int>(in.value<std::uint32_t>());
  if (version >= 5) in.skip(in.value<std::uint32_t>());  // its name
  constexpr int kNone = 0, kPlumbBob = 1;
  const int distortion = version >= 6 ? in.value<std::uint8_t>() : kPlumbBob;
  in.end();
  if (distortion == kPlumbBob) {
    p.k1 = dist[0], p.k2 = dist[1], p.p1 = dist[2], p.p2 = dist[3], p.k3 = dist[4];
    if (dist[5] != 0 || dist[6] != 0 || dist[7] != 0) in.fail();
  } else if (distortion != kNone) {
    in.fail();
  }
  const bool calibrated = p.fx > 0 && p.fy > 0 && base::plausibleSize(camera.size.width, camera.size.height);
  if (!calibrated) in.fail();
  return camera;
}

}  // namespace

std::optional<RecordedCamera> recordedCamera(std::span<const std::uint8_t> bytes) {
  Cursor in(bytes);
  const Eigen::Isometry3d pose = readPose3D(in);
  in.end();
  RecordedCamera camera = readCamera(in);
  camera.T_robot_cam = pose;
  return in.ok() ? std::optional(camera) : std::nullopt;
}

std::optional<RecordedPair> recordedPair(std::span<const std::uint8_t> bytes) {
  Cursor in(bytes);
  in.header(kQuaternionPose);
  const Eigen::Isometry3d pose = readQuaternionPose(in);
  in.end();
  RecordedPair pair;
  pair.left = readCamera(in);
  pair.right = readCamera(in);
  pair.left.T_robot_cam = pair.right.T_robot_cam = pose;
  return in.ok() ? std::optional(pair) : std::nullopt;
}

std::optional<Eigen::Isometry3d> lastPose(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto at = text.rfind(kQuaternionPose);
  if (at == std::string_view::npos) return std::nullopt;
  Cursor in(bytes.subspan(at + kQuaternionPose.size() + 1));  // and its version
  const Eigen::Isometry3d pose = readQuaternionPose(in);
  in.end();
  return in.ok() ? std::optional(pose) : std::nullopt;
}

cameras::CameraRig toRig(const RecordedCamera& camera) {
  cameras::CameraRig rig = cameras::makeRig(std::make_shared<cameras::Pinhole>(camera.size, camera.plane));
  if (!camera.T_robot_cam.matrix().isIdentity()) rig.T_robot_cam = camera.T_robot_cam;
  return rig;
}

cameras::StereoRig toStereoRig(const RecordedCamera& left, const RecordedCamera& right) {
  const auto rig = [](const RecordedCamera& camera) {
    cameras::CameraRig out = cameras::makeRig(std::make_shared<cameras::Pinhole>(camera.size, camera.plane));
    out.T_robot_cam = camera.T_robot_cam;
    return out;
  };
  return {rig(left), rig(right)};
}

}  // namespace engram::sources

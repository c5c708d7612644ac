// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry/odometry_run.h"

#include "engram/base/error.h"

#include <chrono>

namespace engram::apps {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

OdometryRunner::OdometryRunner(const cameras::Rectifier& rectifier, const odometry::OdometryParams& params,
                               bool wheels)
    : rectifier_(rectifier),
      odometry_(rectifier.model(), rectifier.mask(), params),
      wheels_(wheels),
      T_world_keyframe_(rectifier.T_robot_cam()),
      T_world_last_(rectifier.T_robot_cam()) {}

/// The motion of the left camera since the last frame, by the wheels.
std::optional<Eigen::Isometry3d> OdometryRunner::predicted(const types::Frame& frame) {
  const auto before = lastOdometry_;
  lastOdometry_ = frame.T_odom_robot;
  if (!wheels_ || !before || !lastOdometry_) return std::nullopt;
  const Eigen::Isometry3d& mount = rectifier_.T_robot_cam();
  return mount.inverse() * before->inverse() * *lastOdometry_ * mount;
}

const OdometryFrame& OdometryRunner::add(const types::Frame& frame) {
  if (frame.right.empty())
    throw base::Error("image " + std::to_string(frame.index) + " (" + frame.label +
                      ") has no right one; both eyes of a stereo camera are needed (for two cameras: --set "
                      "source.sensor_label=LEFT --set source.right_label=RIGHT)");
  OdometryFrame out;
  out.index = frame.index;
  out.stamp = frame.stamp;
  auto start = Clock::now();
  const types::StereoPair pair = rectifier_(frame.image, frame.right);
  out.rectifyMs = millisecondsSince(start);
  const auto motion = predicted(frame);
  start = Clock::now();
  out.result = odometry_.process(pair, motion);
  out.odometryMs = millisecondsSince(start);
  check_.add(pair);
  chain(out);
  drive_.frames.push_back(std::move(out));
  return drive_.frames.back();
}

void OdometryRunner::chain(OdometryFrame& out) {
  const auto& result = out.result;
  if (result.ok()) T_world_last_ = T_world_keyframe_ * result.T_keyframe_now.T_a_b;
  if (result.newKeyframe) T_world_keyframe_ = T_world_last_;
  if (!result.ok() && !result.newKeyframe) return;
  if (!result.ok()) drive_.pieces.emplace_back();
  out.T_world_robot = T_world_last_ * rectifier_.T_robot_cam().inverse();
  drive_.pieces.back().push_back({out.stamp, *out.T_world_robot});
}

}  // namespace engram::apps

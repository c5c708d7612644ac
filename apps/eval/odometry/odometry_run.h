// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/rectifier.h"
#include "engram/evaluation/trajectory.h"
#include "engram/odometry/stereo_check.h"
#include "engram/odometry/stereo_odometry.h"
#include "engram/sources/frame_source.h"

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// What became of one frame.
struct OdometryFrame {
  std::uint64_t index = 0;
  double stamp = 0.0;
  odometry::OdometryResult result;
  std::optional<Eigen::Isometry3d> T_world_robot;  ///< none where the motion is unknown
  double rectifyMs = 0, odometryMs = 0;            ///< wall time
  double milliseconds() const { return rectifyMs + odometryMs; }
};

/// A drive by visual odometry alone: the frames, and the trajectory in pieces between failures.
struct OdometryDrive {
  std::vector<OdometryFrame> frames;
  /// World is where the robot was at the first frame. After a failure a new piece begins where the last pose
  /// was: what happened between is unknown.
  std::vector<evaluation::Trajectory> pieces;
};

/// Takes frame after frame through visual odometry and chains the motions.
class OdometryRunner {
 public:
  /// @param wheels predict the motion with the odometry of the frames, where they have it.
  OdometryRunner(const cameras::Rectifier& rectifier, const odometry::OdometryParams& params, bool wheels);

  /// Throws base::Error for a frame without a right image or of another size.
  const OdometryFrame& add(const types::Frame& frame);
  const OdometryDrive& drive() const { return drive_; }
  odometry::StereoHealth health() const { return check_.health(); }

 private:
  std::optional<Eigen::Isometry3d> predicted(const types::Frame& frame);
  void chain(OdometryFrame& out);

  const cameras::Rectifier& rectifier_;
  odometry::StereoOdometry odometry_;
  odometry::StereoCheck check_;
  bool wheels_;
  std::optional<Eigen::Isometry3d> lastOdometry_;
  Eigen::Isometry3d T_world_keyframe_, T_world_last_;  // of the left camera
  OdometryDrive drive_;
};

}  // namespace engram::apps

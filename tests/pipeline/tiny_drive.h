// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"
#include "engram/types/frame.h"

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace engram::testing {

/// Frames of a drive through the tiny building with the truth of each.
struct DriveFrames {
  std::vector<types::Frame> frames;
  std::vector<Eigen::Isometry3d> T_world_robot;
  /// True path [m].
  double length() const {
    double sum = 0;
    for (std::size_t i = 1; i < T_world_robot.size(); ++i)
      sum += (T_world_robot[i].translation() - T_world_robot[i - 1].translation()).norm();
    return sum;
  }
};

/// Once round the building on the first day, and again weeks later: other light, some posters and furniture
/// changed. Rendered once per test binary with the omnidirectional camera of share/cameras.
const DriveFrames& firstDrive();
const DriveFrames& secondDrive();

/// A configuration for that camera.
pipeline::PipelineParams tinyParams();

}  // namespace engram::testing

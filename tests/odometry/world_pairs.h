// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/rectifier.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/types/stereo.h"

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace engram::odometry::testing_world {

struct Shown {
  types::StereoPair raw;  ///< as the two cameras see it, grey
  Eigen::Isometry3d T_world_robot;
};

/// The simulator's stereo camera at half the pixels.
cameras::StereoRig smallRig();
/// The same head as it leaves the factory: lenses with distortion, not quite parallel, not quite level.
cameras::StereoRig crookedRig();

/// What a rig sees in the office building on its first day, without people, where the robot drives along the
/// tour: `frames` pairs from arc length `start` [m], `step` [m] apart.
std::vector<Shown> driveThroughOffice(const cameras::StereoRig& rig, int frames, double step,
                                      double start = 1);

/// Pairs with the rectifier that made them.
struct Rectified {
  cameras::Rectifier rectifier;
  std::vector<types::StereoPair> pairs;
  std::vector<Eigen::Isometry3d> T_world_cam;  ///< of the rectified left camera
};
Rectified rectify(const cameras::StereoRig& rig, const std::vector<Shown>& shown);

}  // namespace engram::odometry::testing_world

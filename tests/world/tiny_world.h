// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/world/world.h"

namespace engram::world {

inline const World& tinyWorld() {
  static const World world = World::preset("tiny", {});
  return world;
}

/// The omnidirectional or ordinary camera at a quarter of the pixels, for speed.
inline Eyes smallEyes(const std::string& name) {
  Eyes eyes = presetEyes(name);
  const auto shrink = [](cameras::CameraRig& rig) {
    cameras::CameraRig small = cameras::makeRig(rig.camera->scaled(0.25, 0.25));
    small.T_robot_cam = rig.T_robot_cam;
    rig = small;
  };
  shrink(eyes.left);
  if (eyes.right) shrink(*eyes.right);
  return eyes;
}

}  // namespace engram::world

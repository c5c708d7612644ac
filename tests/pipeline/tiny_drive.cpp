// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tiny_drive.h"

#include "engram/base/parallel.h"
#include "engram/world/world.h"

namespace engram::testing {
namespace {

DriveFrames render(int session) {
  static const world::World world = world::World::preset("tiny", {});
  const world::Session drive(world, session, world::presetEyes("omni"));
  DriveFrames result;
  result.frames.resize(drive.size());
  base::parallelFor(drive.size(), 2, [&](std::size_t i) { result.frames[i] = drive.frame(i); });
  for (std::size_t i = 0; i < drive.size(); ++i) result.T_world_robot.push_back(drive.T_world_robot(i));
  return result;
}

}  // namespace

const DriveFrames& firstDrive() {
  static const DriveFrames drive = render(1);
  return drive;
}

const DriveFrames& secondDrive() {
  static const DriveFrames drive = render(2);
  return drive;
}

pipeline::PipelineParams tinyParams() {
  pipeline::PipelineParams params;
  params.camera.file = ENGRAM_SOURCE_DIR "/share/cameras/omni_world.ini";
  return params;
}

}  // namespace engram::testing

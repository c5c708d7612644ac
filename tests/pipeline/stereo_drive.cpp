// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_drive.h"

#include "engram/base/atomic_file.h"
#include "engram/base/parallel.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/world/world.h"

#include <gtest/gtest.h>

namespace engram::testing {
namespace {

world::Eyes smallEyes() {
  world::Eyes eyes = world::presetEyes("stereo");
  const auto shrink = [](const cameras::CameraRig& rig) {
    cameras::CameraRig small = cameras::makeRig(rig.camera->scaled(0.5, 0.5));
    small.T_robot_cam = rig.T_robot_cam;
    return small;
  };
  eyes.left = shrink(eyes.left);
  eyes.right = shrink(*eyes.right);
  return eyes;
}

DriveFrames render(int session, std::size_t from, std::size_t to) {
  static const world::World world = [] {
    world::WorldParams params;
    params.change.people = 0;
    params.change.light = false;
    params.drive.spacing = 0.08;
    params.drive.turn_spacing = 0.06;
    params.sensor.samples = 1;
    return world::World::preset("tiny", params);
  }();
  const world::Session drive(world, session, smallEyes());
  DriveFrames result;
  result.frames.resize(to - from);
  base::parallelFor(to - from, 2, [&](std::size_t i) { result.frames[i] = drive.frame(from + i); });
  for (std::size_t i = from; i < to; ++i) result.T_world_robot.push_back(drive.T_world_robot(i));
  return result;
}

}  // namespace

const DriveFrames& firstStereoDrive() {
  static const DriveFrames drive = render(1, 0, 60);
  return drive;
}

const DriveFrames& secondStereoDrive() {
  static const DriveFrames drive = render(2, 15, 60);
  return drive;
}

pipeline::PipelineParams stereoParams() {
  static const std::string file = [] {
    const std::string path = ::testing::TempDir() + "engram_small_stereo.ini";
    const world::Eyes eyes = smallEyes();
    base::writeText(path, cameras::toText(cameras::StereoRig{eyes.left, *eyes.right}), true);
    return path;
  }();
  pipeline::PipelineParams p;
  base::Config config;
  p.bind(config);
  config.read(base::IniFile::load(ENGRAM_SOURCE_DIR "/config/view_map.ini"));
  p.camera.file = file;
  p.views.min_interval = 0.3;
  return p;
}

}  // namespace engram::testing

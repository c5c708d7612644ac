// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "golden_drives.h"

#include "engram/base/parallel.h"
#include "engram/cameras/camera_rig.h"
#include "engram/world/world.h"

#include <map>

namespace engram::testing {
namespace {

/// Which images of a tour, how far apart.
struct Part {
  std::size_t from = 0, to = 0, step = 1;
};

struct Script {
  double spacing;  ///< [m]
  Part first, second;
};

/// Most drive once round the building and on, so that a loop closes; the second day begins in the middle. A
/// stereo robot drives a few metres with the short steps that visual odometry needs.
Script scriptOf(const std::string& eye) {
  if (eye == "stereo") return {0.10, {0, 30}, {10, 34}};
  if (eye == "pano") return {0.5, {0, 8}, {3, 8}};
  return {0.5, {0, 1000}, {6, 22}};
}

world::Eyes eyesOf(const std::string& eye) {
  if (eye != "pano") return world::presetEyes(eye);
  return {eye, cameras::loadCamera(ENGRAM_SOURCE_DIR "/share/cameras/equirectangular_2048.ini"), {}};
}

std::vector<types::Frame> render(const world::World& world, const std::string& eye, int day, Part part) {
  const world::Session drive(world, day, eyesOf(eye));
  std::vector<types::Frame> frames;
  for (std::size_t i = part.from; i < std::min(part.to, drive.size()); i += part.step) {
    frames.emplace_back();
    frames.back().index = i;
  }
  base::parallelFor(frames.size(), 2, [&](std::size_t k) { frames[k] = drive.frame(frames[k].index); });
  return frames;
}

GoldenDrives renderBoth(const std::string& eye) {
  const Script script = scriptOf(eye);
  world::WorldParams params;
  params.drive.spacing = script.spacing;
  params.drive.turn_spacing = script.spacing;
  params.sensor.samples = 1;
  params.drive.laps = 1.2;
  const world::World world = world::World::preset("tiny", params);
  return {render(world, eye, 1, script.first), render(world, eye, 2, script.second)};
}

}  // namespace

const GoldenDrives& goldenDrives(const std::string& eye) {
  static std::map<std::string, GoldenDrives> rendered;
  const auto at = rendered.find(eye);
  return at != rendered.end() ? at->second : rendered.emplace(eye, renderBoth(eye)).first->second;
}

pipeline::PipelineParams goldenParams(const GoldenCase& golden) {
  base::IniFile ini = base::IniFile::load(ENGRAM_SOURCE_DIR "/config/" + golden.config + ".ini");
  for (const auto& assignment : golden.overrides) ini.override(assignment);
  for (const char* live : {"front", "front.features"}) ini.take(live);
  pipeline::PipelineParams params;
  base::Config config;
  params.bind(config);
  config.read(ini);
  return params;
}

}  // namespace engram::testing

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_world.h"

#include "common/kept_file.h"
#include "engram/base/atomic_file.h"
#include "engram/base/progress.h"
#include "engram/base/rng.h"
#include "words/words_run_file.h"

#include <algorithm>
#include <filesystem>
#include <functional>

namespace engram::apps {
namespace fs = std::filesystem;

void WordsWorldParams::describe(base::Params& p) {
  p.add("attempts", attempts, "attempts at global localisation, for each setting and transition",
        {1, 100000});
  p.add("right_within", right_within, "a place is right when the robot is this near to it [m]", {0.1, 100});
}

const WordsPlan& wordsPlan(bool quick) {
  static const WordsPlan whole{
      {{"office", "office", 2, 1, true, "A ring of corridors and four of its rooms, twice round."},
       {"corridors", "corridors", 2, 1, true, "A ladder of corridors that look alike, twice round."},
       {"campus", "campus", 2, 1, true, "Streets between houses under the sky, twice round."},
       {"loops", "loops", 1, 1, true,
        "A drive of the paper's kind: a small loop in a room, then a long one round the corridors, and "
        "back."},
       {"corridors_later", "corridors", 1, 3, false, ""}},
      {{"indoor", "corridors", "corridors", "corridors that look alike, the same day"},
       {"indoor, later", "corridors", "corridors_later",
        "the same corridors at night, two months later, with other posters and furniture"},
       {"outdoor", "campus", "campus", "streets, the same day"}}};
  static const WordsPlan small{{{"tiny", "tiny", 2, 1, true, "One corridor and a room, twice round."}},
                               {{"indoor", "tiny", "tiny", "one corridor and a room"}}};
  return quick ? small : whole;
}

WordsWorld::WordsWorld(const WordsPlan& plan, const WordsWorldParams& params, const world::WorldParams& world,
                       const pipeline::PipelineParams& pipeline, Workplace place)
    : plan_(plan), params_(params), world_(world), pipeline_(pipeline), place_(std::move(place)) {
  base::validate(params_);
}

std::string WordsWorld::runFile(const std::string& name) const {
  return place_.file("runs/" + name + ".json");
}

const KeptDrive& WordsWorld::driveOf(const std::string& name) const {
  const auto at = std::find_if(plan_.drives.begin(), plan_.drives.end(),
                               [&](const PlannedDrive& d) { return d.name == name; });
  return drives_.at(static_cast<std::size_t>(at - plan_.drives.begin()));
}

/// The robot's camera is that of the configuration; without one it is the simulator's ordinary camera, with
/// the 320 x 240 pixels of A-20.
void WordsWorld::recordDrives() {
  const fs::path folder = place_.subfolder("drives");
  world::Eyes eyes = world::presetEyes("pinhole");
  if (pipeline_.camera.file.empty()) {
    cameras::CameraRig small = cameras::makeRig(eyes.left.camera->scaled(0.5, 0.5));
    small.T_robot_cam = eyes.left.T_robot_cam;
    eyes.left = small;
    pipeline_.camera.file = (folder / "camera.ini").string();
    base::writeText(pipeline_.camera.file, cameras::toText(eyes.left), true);
  } else {
    eyes = {pipeline_.camera.file, cameras::loadCamera(pipeline_.camera.file), {}};
  }
  base::Progress progress(place_.progress, "drives");
  double all = 0, before = 0;
  for (const PlannedDrive& drive : plan_.drives) all += drive.laps;
  for (const PlannedDrive& drive : plan_.drives) {
    const auto tick = [&](double share) {
      progress.update((before + share * drive.laps) / all, drives_.size());
    };
    world::WorldParams params = world_;
    params.drive.laps = drive.laps;
    const auto world = world::World::preset(drive.preset, params);
    drives_.push_back(
        keepDrive(world, eyes, drive.day, (folder / drive.name).string(), place_.threads, tick));
    before += drive.laps;
  }
}

MappingRun WordsWorld::mapped(std::size_t drive) const {
  const std::string& name = plan_.drives[drive].name;
  return kept(
      runFile("mapping_" + name),
      [&] { return mapDrive(name, drives_[drive], pipeline_, params_.right_within); }, writeMappingRun,
      readMappingRun);
}

std::vector<LocalisationRun> WordsWorld::located(const LocatedSetting& setting) const {
  const auto seed = base::Rng(world_.seed).fork(21).bits();  // the same images for every transition
  std::optional<LocalisationWorld> world;
  std::vector<LocalisationRun> runs;
  for (const Transition& transition : transitions()) {
    const auto measured = [&] {
      if (!world) world = learnFirstLap(driveOf(setting.learnt), driveOf(setting.shown), pipeline_);
      LocalisationRun run =
          localise(*world, transition, pipeline_, params_.attempts, seed, params_.right_within);
      run.setting = setting.name;
      return run;
    };
    runs.push_back(kept(runFile("localisation_" + setting.shown + "_" + transition.name), measured,
                        writeLocalisationRun, readLocalisationRun));
  }
  return runs;
}

WordsWorldResult WordsWorld::run() {
  for (const Transition& transition : transitions()) with(transition, pipeline_);  // refuses before the work
  recordDrives();
  place_.subfolder("runs");
  std::vector<std::vector<LocalisationRun>> located(plan_.settings.size());
  std::vector<std::optional<MappingRun>> mapped(plan_.drives.size());
  std::vector<std::function<void()>> jobs;  // the longest first
  for (std::size_t i = 0; i < plan_.settings.size(); ++i)
    jobs.emplace_back([&, i] { located[i] = this->located(plan_.settings[i]); });
  for (std::size_t i = 0; i < plan_.drives.size(); ++i)
    if (plan_.drives[i].mapped) jobs.emplace_back([&, i] { mapped[i] = this->mapped(i); });
  runJobs(place_, jobs);

  WordsWorldResult result;
  for (auto& run : mapped)
    if (run) result.mapping.push_back(std::move(*run));
  for (auto& runs : located)
    for (auto& run : runs) result.localisation.push_back(std::move(run));
  return result;
}

}  // namespace engram::apps

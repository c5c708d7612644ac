// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words_world.h"

#include "engram/base/atomic_file.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/base/rng.h"
#include "words_run_file.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <mutex>

namespace engram::apps {
namespace fs = std::filesystem;

void WordsWorldParams::describe(base::Params& p) {
  p.add("attempts", attempts, "attempts at global localisation, for each setting and transition",
        {1, 100000});
  p.add("right_within", right_within, "a place is right when the robot is this near to it [m]", {0.1, 100});
}

const WordsPlan& wordsPlan(bool quick) {
  static const WordsPlan whole{{{"office", "office", 2, "a ring of corridors and four of its rooms"},
                                {"corridors", "corridors", 2, "a ladder of corridors that look alike"}},
                               {{"indoor", "corridors", "corridors that look alike"}}};
  static const WordsPlan small{{{"tiny", "tiny", 2, "one corridor and a room"}},
                               {{"indoor", "tiny", "one corridor and a room"}}};
  return quick ? small : whole;
}

WordsWorld::WordsWorld(const WordsPlan& plan, const WordsWorldParams& params, const world::WorldParams& world,
                       const pipeline::PipelineParams& pipeline, Options options)
    : plan_(plan), params_(params), world_(world), pipeline_(pipeline), options_(std::move(options)) {
  base::validate(params_);
}

std::string WordsWorld::runFile(const std::string& name) const {
  return (fs::path(options_.folder) / "runs" / (name + ".json")).string();
}

const KeptDrive& WordsWorld::driveOf(const std::string& building) const {
  const auto at = std::find_if(plan_.buildings.begin(), plan_.buildings.end(),
                               [&](const MappedBuilding& b) { return b.name == building; });
  return drives_.at(static_cast<std::size_t>(at - plan_.buildings.begin()));
}

/// The robot's camera is that of the configuration; without one it is the simulator's ordinary camera.
void WordsWorld::recordDrives() {
  const fs::path folder = fs::path(options_.folder) / "drives";
  fs::create_directories(folder);
  world::Eyes eyes = world::presetEyes("pinhole");
  if (pipeline_.camera.file.empty()) {
    pipeline_.camera.file = (folder / "camera.ini").string();
    base::writeText(pipeline_.camera.file, cameras::toText(eyes.left), true);
  } else {
    eyes = {pipeline_.camera.file, cameras::loadCamera(pipeline_.camera.file), {}};
  }
  base::Progress progress(options_.progress, "drives");
  for (const MappedBuilding& building : plan_.buildings) {
    const auto done = drives_.size();
    const auto tick = [&](double share) {
      progress.update((static_cast<double>(done) + share) / static_cast<double>(plan_.buildings.size()),
                      done);
    };
    world::WorldParams params = world_;
    params.drive.laps = building.laps;
    const auto world = world::World::preset(building.preset, params);
    drives_.push_back(keepDrive(world, eyes, 1, (folder / building.name).string(), options_.threads, tick));
  }
}

MappingRun WordsWorld::mapped(const MappedBuilding& building, const KeptDrive& drive) const {
  const std::string file = runFile("mapping_" + building.name);
  if (!fs::exists(file)) writeRun(file, mapDrive(building.name, drive, pipeline_, params_.right_within));
  return readMappingRun(file);  // also after a fresh run: both ways give the same digits
}

std::vector<LocalisationRun> WordsWorld::located(const LocatedSetting& setting,
                                                 const KeptDrive& drive) const {
  const auto fileOf = [&](const Transition& t) {
    return runFile("localisation_" + setting.name + "_" + t.name);
  };
  const std::uint64_t seed = base::Rng(world_.seed).fork(21).bits();  // the same images for every transition
  std::optional<LocalisationWorld> world;
  std::vector<LocalisationRun> runs;
  for (const Transition& transition : transitions()) {
    const std::string file = fileOf(transition);
    if (!fs::exists(file)) {
      if (!world) world = learnFirstLap(drive, pipeline_);
      LocalisationRun run =
          localise(*world, drive.truth, transition, pipeline_, params_.attempts, seed, params_.right_within);
      run.setting = setting.name;
      writeRun(file, run);
    }
    runs.push_back(readLocalisationRun(file));
  }
  return runs;
}

WordsWorldResult WordsWorld::run() {
  for (const Transition& transition : transitions()) with(transition, pipeline_);  // refuses before the work
  recordDrives();
  fs::create_directories(fs::path(options_.folder) / "runs");
  std::vector<std::vector<LocalisationRun>> located(plan_.settings.size());
  WordsWorldResult result;
  result.mapping.resize(plan_.buildings.size());
  std::vector<std::function<void()>> jobs;  // the longest first
  for (std::size_t i = 0; i < plan_.settings.size(); ++i)
    jobs.emplace_back([&, i] {
      const LocatedSetting& setting = plan_.settings[i];
      located[i] = this->located(setting, driveOf(setting.building));
    });
  for (std::size_t i = 0; i < plan_.buildings.size(); ++i)
    jobs.emplace_back([&, i] { result.mapping[i] = mapped(plan_.buildings[i], drives_[i]); });

  base::Progress progress(options_.progress, "experiments");
  std::mutex mutex;
  std::size_t done = 0;
  progress.update(0, 0);
  base::parallelFor(jobs.size(), options_.threads, [&](std::size_t k) {
    jobs[k]();
    const std::lock_guard lock(mutex);
    ++done;
    progress.update(static_cast<double>(done) / static_cast<double>(jobs.size()), done);
  });
  for (auto& runs : located)
    for (auto& run : runs) result.localisation.push_back(std::move(run));
  return result;
}

}  // namespace engram::apps

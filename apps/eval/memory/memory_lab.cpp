// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/memory_lab.h"

#include "common/kept_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/base/rng.h"
#include "memory/method_run_file.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace engram::apps {
namespace {

constexpr int kBlocksPerDrive = 8;

std::vector<Sequence> drawSequences(const std::vector<RecordedDrive>& tests, const MemoryLabParams& params,
                                    std::uint64_t seed) {
  base::Rng rng = base::Rng(seed).fork(25);
  std::vector<Sequence> sequences;
  for (int s = 0; s < params.sequences; ++s) {
    Sequence sequence;
    sequence.drive = static_cast<int>(rng.below(static_cast<std::uint32_t>(tests.size())));
    const auto size = static_cast<int>(tests[static_cast<std::size_t>(sequence.drive)].samples.size());
    if (size < params.sequence_length)
      throw base::Error("[memory_lab] sequence_length = " + std::to_string(params.sequence_length) +
                        ": a test drive has only " + std::to_string(size) + " images");
    const int starts = size - params.sequence_length + 1;
    sequence.first = static_cast<int>(rng.below(static_cast<std::uint32_t>(starts)));
    sequence.block = sequence.drive * kBlocksPerDrive + sequence.first * kBlocksPerDrive / starts;
    sequences.push_back(sequence);
  }
  return sequences;
}

types::Features underCondition(const Sample& sample, const Condition& condition, std::uint64_t seed) {
  const types::Features& features = condition.noisy ? sample.noisy : sample.features;
  return condition.removed > 0 ? without(features, condition.removed, seed) : features;
}

}  // namespace

void MemoryLabParams::describe(base::Params& p) {
  p.addChoice("preset", preset, "building of the simulator", {"tiny", "office", "corridors"});
  p.add("places", places, "places, evenly spaced along the tour", {3, 1000});
  p.add("updates", updates, "drives that are learnt from; the first builds the map", {1, 99});
  p.add("test_days", test_days, "test drives, on the days after the last update", {1, 20});
  p.add("test_spacing", test_spacing, "between test images [m]", {0.1, 10});
  p.add("sequences", sequences, "random sequences for each figure", {1, 100000});
  p.add("sequence_length", sequence_length, "images in each sequence", {2, 1000});
  p.add("noise", noise, "sigma of the image noise, for intensities in [0, 1]", {0.001, 1});
  p.add("bow_words", bow_words, "words of the larger bag-of-words dictionary", {2, 100000});
}

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> all{
      {"clean", false, 0.0}, {"noise", true, 0.0}, {"noise_25", true, 0.25}, {"noise_50", true, 0.5}};
  return all;
}

double ringDistance(double a, double b, double places) { return std::abs(std::remainder(a - b, places)); }

MemoryLab::MemoryLab(const MemoryLabParams& params, const pipeline::PipelineParams& pipeline, Workplace place)
    : params_(params), pipeline_(pipeline), place_(std::move(place)) {
  base::validate(params_);
}

double MemoryLab::trueStation(const Sample& sample) const {
  return sample.arc / drives_.tours.front().tourLength * params_.places;
}

void MemoryLab::record() {
  world::WorldParams params;
  params.seed = place_.seed;
  const world::World world = world::World::preset(params_.preset, params);
  params.drive.spacing = params_.test_spacing;
  const world::World testWorld = world::World::preset(params_.preset, params);
  const std::string folder = place_.subfolder("drives");
  DriveRecorder tours(world, world::presetEyes("omni"), pipeline_.extractor, {folder, 0.0, place_.threads});
  DriveRecorder tests(testWorld, world::presetEyes("omni"), pipeline_.extractor,
                      {folder, params_.noise, place_.threads});

  base::Progress progress(place_.progress, "recording");
  const int all = params_.updates + params_.test_days;
  std::size_t images = 0;
  drives_ = {};
  for (int day = 1; day <= all; ++day) {
    const auto tick = [&](std::size_t done) {
      progress.update((day - 1 + static_cast<double>(done) / params_.places) / all, images + done);
    };
    const bool test = day > params_.updates;
    auto drive = test ? tests.record(day, world::DriveKind::kTest, allImages(), tick)
                      : tours.record(day, world::DriveKind::kTour,
                                     nearestToStations(params_.places, world.route().length()), tick);
    images += drive.samples.size();
    (test ? drives_.tests : drives_.tours).push_back(std::move(drive));
  }
  progress.finish();
  sequences_ = drawSequences(drives_.tests, params_, place_.seed);
}

std::vector<LearnView> MemoryLab::learnViews(const RecordedDrive& drive) const {
  std::vector<LearnView> views;
  for (const Sample& sample : drive.samples) {
    LearnView view;
    view.frame.index = views.size();
    view.frame.stamp = sample.stamp;
    view.frame.T_odom_robot = sample.T_odom_robot;
    view.features = sample.features;
    views.push_back(std::move(view));
  }
  return views;
}

std::vector<MethodRun> MemoryLab::run(const std::vector<Method>& methods,
                                      const std::vector<Condition>& conditions, const std::string& kind) {
  const std::string folder = place_.subfolder(kind);
  std::vector<MethodRun> runs(methods.size());
  runJobs(place_, kind, methods.size(), [&](std::size_t m) {
    runs[m] = kept(
        folder + "/" + methods[m].name + ".json", [&] { return runOne(methods[m], conditions); },
        writeMethodRun, readMethodRun);
  });
  return runs;
}

MethodRun MemoryLab::runOne(const Method& method, const std::vector<Condition>& conditions) const {
  MethodRun run;
  run.method = method.name;
  std::vector<Eigen::Isometry3d> poses;
  for (const Sample& sample : drives_.tours.front().samples) poses.push_back(sample.T_world_robot);
  const auto isRight = [&](std::size_t station, base::PlaceId place) {
    return ringDistance(place.value, static_cast<double>(station), params_.places) <= 1;
  };

  const auto contender = makeContender(method, learnViews(drives_.tours.front()), poses, true);
  for (int update = 1; update <= params_.updates; ++update) {
    Learning learning;
    if (update > 1)
      learning = contender->learn(learnViews(drives_.tours[static_cast<std::size_t>(update - 1)]), isRight);
    run.updates.push_back({contender->holdings(), learning});
    for (const Condition& condition : conditions) {
      if (base::interrupted()) throw base::Interrupted("testing " + method.name);
      run.cells.push_back(test(*contender, method, condition, update));
    }
  }
  return run;
}

Cell MemoryLab::test(const Contender& contender, const Method& method, const Condition& condition,
                     int update) const {
  // Scores do not depend on the belief: each image is compared once, however many sequences it is in.
  std::vector<std::vector<std::optional<std::vector<double>>>> scores;
  for (const auto& drive : drives_.tests) scores.emplace_back(drive.samples.size());
  pipeline::Recogniser filter(method.params, pipeline::Recogniser::Mode::kLocalisation);
  filter.load(contender.map());

  Cell cell{condition.name, update, {}, {}};
  for (const Sequence& sequence : sequences_) {
    const auto d = static_cast<std::size_t>(sequence.drive);
    filter.restart();
    for (int k = 0; k < params_.sequence_length; ++k) {
      const auto i = static_cast<std::size_t>(sequence.first + k);
      const Sample& sample = drives_.tests[d].samples[i];
      auto& known = scores[d][i];
      if (!known)
        known = contender.scores(
            underCondition(sample, condition, base::Rng(place_.seed).fork(d << 32 | i).bits()));
      const auto hypotheses = filter.weigh(*known, std::nullopt);
      const double station = trueStation(sample);
      const double whole = hypotheses.front().place.value;
      cell.interpolated.push_back(
          static_cast<float>(ringDistance(filter.interpolatedPeak(), station, params_.places)));
      cell.whole.push_back(static_cast<float>(ringDistance(whole, std::round(station), params_.places)));
    }
  }
  return cell;
}

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_localisation.h"

#include "common/cpu_clock.h"
#include "engram/base/config.h"
#include "engram/base/interrupt.h"
#include "engram/pipeline/dead_reckoning.h"
#include "engram/pipeline/pipeline.h"

#include <algorithm>

namespace engram::apps {
namespace {

/// The rule of A-06 over the odometry: which images are used.
class ImageRule {
 public:
  explicit ImageRule(const pipeline::PipelineParams& params)
      : select_(params.select), reckoning_(params.odometry) {}

  bool uses(const types::Frame& frame) {
    reckoning_.move(frame.T_odom_robot);
    if (!first_ && reckoning_.distance() < select_.min_distance &&
        reckoning_.rotation() < select_.min_rotation)
      return false;
    first_ = false;
    reckoning_.markKeyframe();
    return true;
  }

 private:
  pipeline::SelectParams select_;
  pipeline::DeadReckoning reckoning_;
  bool first_ = true;
};

}  // namespace

const std::vector<Transition>& transitions() {
  static const std::vector<Transition> all{
      {"blind",
       "Gaussian over the number of edges, neighbours before the place itself (A-16); no odometry",
       false,
       {"belief.advance=none", "belief.expected_hops=1", "recognise.sure_inliers=0"}},
      {"distance",
       "the same, with the distance that odometry reports, not its direction",
       true,
       {"belief.advance=none", "recognise.sure_inliers=0"}},
      {"odometry",
       "the belief moves in the direction and over the distance that odometry reports (A-25)",
       true,
       {"belief.advance=odometry", "recognise.sure_inliers=0"}},
      {"configured",
       "as configured: by default, the same, and a place with enough verified matches needs no belief",
       true,
       {}},
  };
  return all;
}

pipeline::PipelineParams with(const Transition& transition, const pipeline::PipelineParams& params) {
  pipeline::PipelineParams changed = params;
  base::Config config;
  changed.bind(config);
  base::IniFile ini = base::IniFile::parse("", "transition " + transition.name);
  for (const auto& assignment : transition.overrides) ini.override(assignment);
  config.read(ini);
  return changed;
}

LocalisationWorld learnFirstLap(const KeptDrive& learnt, const KeptDrive& shown,
                                const pipeline::PipelineParams& params) {
  LocalisationWorld world;
  world.learnt = learnt.truth;
  const std::size_t firstLap = learnt.firstLapImages();
  pipeline::Pipeline mapper(params);
  learnt.forEachFrame([&](const types::Frame& frame) {
    if (frame.index >= firstLap) return;
    const auto outcome = mapper.process(frame).outcome;
    world.learned += outcome != types::Outcome::kSkipped && outcome != types::Outcome::kUnusable;
  });
  mapper.finish();
  world.map = std::move(mapper).release();

  pipeline::Perception perception(params.camera, params.extractor);
  ImageRule rule(params);
  const std::size_t from = &learnt == &shown ? firstLap : 0;
  double seconds = 0;
  shown.forEachFrame([&](const types::Frame& frame) {
    if (frame.index < from || !rule.uses(frame)) return;
    PassImage image{frame, {}, shown.truth.at(frame.index).T_world_body};
    types::FrameReport report;
    const double start = threadSeconds();
    if (auto features = perception.look(frame, 0, report)) image.features = std::move(*features);
    seconds += threadSeconds() - start;
    image.frame.image = cv::Mat();
    world.images.push_back(std::move(image));
  });
  world.shown = world.learned + static_cast<int>(world.images.size());
  world.extractionSeconds = seconds / static_cast<double>(std::max<std::size_t>(1, world.images.size()));
  return world;
}

LocalisationRun localise(const LocalisationWorld& world, const Transition& transition,
                         const pipeline::PipelineParams& params, int count, std::uint64_t seed,
                         double rightWithin) {
  pipeline::Pipeline localizer(with(transition, params), world.map, pipeline::Use::kFrozen);
  const auto isRight = [&](const PassImage& image, base::PlaceId id) {
    const auto& place = world.learnt.at(world.map.place(id).createdIndex).T_world_body;
    return (place.translation() - image.T_world_robot.translation()).norm() <= rightWithin;
  };
  double seconds = 0;
  int asked = 0;
  const AskImage ask = [&](std::size_t i, bool restart) {
    if (base::interrupted()) throw base::Interrupted("locating images");
    const PassImage& image = world.images[i];
    types::Frame frame = image.frame;
    if (!transition.odometry) frame.T_odom_robot.reset();
    if (restart) localizer.restart();
    types::Features features = image.features;
    const double start = threadSeconds();
    const types::FrameReport report = localizer.process(frame, std::move(features));
    seconds += threadSeconds() - start;
    ++asked;
    PassAnswer answer;
    answer.accepted = report.outcome == types::Outcome::kRecognised;
    answer.right = answer.accepted && isRight(image, report.place);
    answer.bestGuessRight = isRight(image, report.bestGuess);
    answer.verified = std::any_of(report.hypotheses.begin(), report.hypotheses.end(),
                                  [](const types::Hypothesis& h) { return h.inliers >= 0; });
    return answer;
  };
  LocalisationRun run;
  run.transition = transition.name;
  run.places = static_cast<int>(world.map.places().size());
  run.shown = world.shown;
  run.learned = world.learned;
  run.attempts = attempts(count, world.images.size(), seed, ask);
  run.msPerImage = 1000 * (world.extractionSeconds + seconds / std::max(1, asked));
  return run;
}

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/pipeline.h"

#include "engram/base/error.h"
#include "make_steps.h"
#include "steps.h"

#include <utility>

namespace engram::pipeline {
namespace {

std::unique_ptr<Run> makeRun(const PipelineParams& params, map::TopologicalMap map, const Recipe& recipe) {
  const bool frontier = recipe.decide != Decide::kKnown && map.empty();
  const bool wheels = recipe.move == Move::kWheels || params.views.wheels;
  const int session = map.nextSession();
  auto run = std::make_unique<Run>(Run{params,
                                       Perception(params.camera, params.extractor),
                                       std::move(map),
                                       {},
                                       ClosureBook(params.posegraph),
                                       Whereabouts(params.odometry, wheels, frontier),
                                       session});
  run->params.verify = run->perception.withOptics(params.verify);
  if (recipe.decide == Decide::kPlace || recipe.decide == Decide::kScan) run->closures.load(run->map);
  return run;
}

types::FrameReport recordOf(const types::Frame& frame) {
  types::FrameReport report;
  report.index = frame.index;
  report.stamp = frame.stamp;
  report.label = frame.label;
  return report;
}

std::optional<types::RobotPose> poseOf(const Run& run) {
  const base::PlaceId place = run.robot.anchor();
  const auto motion = run.robot.motion();
  if (!motion) return std::nullopt;
  return types::RobotPose{place, *motion, run.map.place(place).T_map_place * motion->T_a_b};
}

Seen given(const types::Frame& frame, types::Features features, types::FrameReport& report) {
  report.features = static_cast<int>(features.size());
  return {frame, std::move(features), {}};
}

}  // namespace

Pipeline::Pipeline(const PipelineParams& params, map::TopologicalMap map, Use use) {
  const Recipe recipe = recipeFor(params, use);
  if (use != Use::kBuild && map.empty())
    throw base::Error("the map holds no places; make one with engram-slam first");
  run_ = makeRun(params, std::move(map), recipe);
  steps_ = std::make_unique<Steps>(makeSteps(recipe, *run_));
}

Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;

/// Each step takes what those before it found. K-19 forgets before it relaxes.
types::FrameReport Pipeline::process(const types::Frame& frame, std::optional<types::Features> features) {
  Run& run = *run_;
  types::FrameReport report = recordOf(frame);
  std::optional<Seen> seen =
      features ? given(frame, std::move(*features), report) : steps_->perceive->perceive(run, frame, report);
  if (!seen) return report;
  const auto motion = steps_->move->move(run, *seen, report);
  if (!motion) return report;
  const auto image = steps_->select->select(run, std::move(*seen), *motion, report);
  if (!image) return report;
  const Evidence evidence = steps_->recognise->recognise(run, *image, report);
  const Verified verified = steps_->verify->verify(run, *image, evidence, report);
  const Decision decision = steps_->decide->decide(run, *image, verified, report);
  const base::PlaceId node = steps_->remember->remember(run, *image, verified, decision, report);
  const Relation relation = steps_->relate->relate(run, *image, verified, decision, node, report);
  if (steps_->forget) steps_->forget->forget(run, relation, report);
  if (steps_->relax) steps_->relax->relax(run, relation, report);
  report.pose = poseOf(run);
  return report;
}

void Pipeline::restart() {
  steps_->remember->finish(*run_);
  steps_->remember->restart();
  steps_->recognise->restart();
  run_->robot.restart();
}

std::vector<base::PlaceId> Pipeline::finish() {
  auto learnt = steps_->remember->finish(*run_);
  if (steps_->relax) steps_->relax->finish(*run_);
  return learnt;
}

std::vector<map::DerivedRow> Pipeline::derived() { return steps_->recognise->derived(*run_); }

const map::TopologicalMap& Pipeline::map() const { return run_->map; }

void Pipeline::keepApart(std::vector<std::pair<base::PlaceId, base::PlaceId>> places) {
  run_->apart = std::move(places);
}

void Pipeline::survey(base::PlaceId place, const Eigen::Isometry3d& T_world_place) {
  run_->map.survey(place, T_world_place);
}

map::TopologicalMap Pipeline::release() && { return std::move(run_->map); }

int Pipeline::session() const { return run_->session; }

map::MapHeader Pipeline::header() const { return run_->perception.mapHeader(run_->params.memory.memory); }

std::optional<odometry::StereoHealth> Pipeline::eyes() const { return run_->perception.eyes(); }

const OdometryHealth& Pipeline::wheels() const { return run_->robot.watch().health(); }

}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "make_steps.h"

#include "perceive_steps.h"
#include "place_steps.h"
#include "recognise_steps.h"
#include "scan_steps.h"
#include "view_steps.h"

namespace engram::pipeline {
namespace {

std::unique_ptr<SelectStep> makeSelect(Select select) {
  if (select == Select::kMotion) return std::make_unique<MotionSelect>();
  if (select == Select::kKeyframe) return std::make_unique<KeyframeSelect>();
  return std::make_unique<EverySelect>();
}

/// Recognise and Verify share what was matched for the one in the other.
void addRecognition(const Recipe& recipe, const Run& run, Steps& steps) {
  if (recipe.recognise == Recognise::kIndex) {
    steps.recognise = std::make_unique<IndexStep>(run);
    steps.verify = std::make_unique<AllViewsStep>();
    return;
  }
  const bool builds = recipe.verify == Verify::kOneOnTerrain;
  auto recogniser = std::make_shared<Recogniser>(
      run.params, builds ? Recogniser::Mode::kMapping : Recogniser::Mode::kLocalisation,
      run.perception.stereo(), appearance::makeDescriber(run.params.appearance, run.perception.panorama()));
  recogniser->load(run.map);
  steps.recognise = std::make_unique<BeliefStep>(recogniser);
  steps.verify = std::make_unique<OnePlaceStep>(
      recogniser, builds ? OnePlaceStep::Fit::kTerrain : OnePlaceStep::Fit::kWay);
}

std::unique_ptr<DecideStep> makeDecide(Decide decide) {
  if (decide == Decide::kPlace) return std::make_unique<PlaceDecide>();
  if (decide == Decide::kView) return std::make_unique<ViewDecide>();
  return std::make_unique<KnownDecide>();
}

std::unique_ptr<RememberStep> makeRemember(Remember remember, const Run& run) {
  if (remember == Remember::kPlace) return std::make_unique<PlaceRemember>(run);
  if (remember == Remember::kView) return std::make_unique<ViewRemember>();
  if (remember == Remember::kLater) return std::make_unique<LaterRemember>(run);
  if (remember == Remember::kUngated) return std::make_unique<UngatedRemember>(run);
  return std::make_unique<NothingRemembered>();
}

std::unique_ptr<RelateStep> makeRelate(Relate relate, const std::optional<upkeep::Budget>& budget) {
  if (relate == Relate::kPlace) return std::make_unique<PlaceRelate>();
  if (relate == Relate::kView) return std::make_unique<ViewRelate>(budget);
  return std::make_unique<FollowRelate>();
}

std::unique_ptr<RelaxStep> makeRelax(Relax relax, const Run& run) {
  if (relax == Relax::kPlace) return std::make_unique<PlaceRelax>(run);
  if (relax == Relax::kView) return std::make_unique<ViewRelax>(run);
  return nullptr;
}

/// The steps of scans share a track.
Steps makeScanSteps(const Recipe& recipe, const Run& run) {
  const auto track = std::make_shared<ScanTrack>(run);
  Steps steps;
  steps.perceive = std::make_unique<ScanPerceive>();
  steps.move = std::make_unique<WheelsStep>();
  steps.select = makeSelect(recipe.select);
  steps.recognise = std::make_unique<NearStep>(track);
  steps.verify = std::make_unique<ScansVerify>(track);
  steps.decide = std::make_unique<ScanDecide>(track);
  steps.remember = std::make_unique<ScanRemember>(track);
  steps.relate = std::make_unique<ScanRelate>(track);
  steps.relax = std::make_unique<ScanRelax>(track);
  return steps;
}

}  // namespace

Steps makeSteps(const Recipe& recipe, const Run& run) {
  if (recipe.perceive == Perceive::kScan) return makeScanSteps(recipe, run);
  std::optional<upkeep::Budget> budget;
  if (recipe.forget == Forget::kLruViews) budget = run.params.upkeep.budget(run.params.stereo.min_inliers);
  Steps steps;
  if (recipe.perceive == Perceive::kPair)
    steps.perceive = std::make_unique<PairStep>();
  else
    steps.perceive = std::make_unique<FeaturesStep>();
  if (recipe.move == Move::kEyes)
    steps.move = std::make_unique<EyesStep>(run);
  else
    steps.move = std::make_unique<WheelsStep>();
  steps.select = makeSelect(recipe.select);
  addRecognition(recipe, run, steps);
  steps.decide = makeDecide(recipe.decide);
  steps.remember = makeRemember(recipe.remember, run);
  steps.relate = makeRelate(recipe.relate, budget);
  if (budget) steps.forget = std::make_unique<LruForget>(*budget);
  steps.relax = makeRelax(recipe.relax, run);
  return steps;
}

}  // namespace engram::pipeline

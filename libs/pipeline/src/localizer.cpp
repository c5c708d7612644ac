// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/localizer.h"

#include "engram/base/error.h"
#include "step_timer.h"

#include <limits>

namespace engram::pipeline {

struct Localizer::Work {
  explicit Work(const types::Frame& f) : frame(f) {}
  const types::Frame& frame;
  types::Features features;
  types::FrameReport report;
  std::optional<PlaceMatch> accepted;  // at report.place
};

Localizer::Localizer(const PipelineParams& params, map::TopologicalMap map, bool adapt)
    : params_(params),
      perception_(params.camera, params.extractor),
      memory_(memory::makeMemoryModel(params.memory, params.fsh, params.multi_store)),
      gate_(params.memory),
      recogniser_(params, Recogniser::Mode::kLocalisation, perception_.stereo()),
      reckoning_(params.odometry),
      sinceLearning_(std::numeric_limits<double>::infinity()),
      map_(std::move(map)),
      adapt_(adapt) {
  if (map_.empty()) throw base::Error("the map holds no places; make one with engram-slam first");
  recogniser_.load(map_);
}

types::FrameReport Localizer::process(const types::Frame& frame) {
  Work work(frame);
  move(work);
  return perceive(work) ? locate(work) : work.report;
}

types::FrameReport Localizer::process(const types::Frame& frame, types::Features features) {
  Work work(frame);
  work.report.index = frame.index;
  work.report.stamp = frame.stamp;
  work.report.label = frame.label;
  work.report.features = static_cast<int>(features.size());
  work.features = std::move(features);
  move(work);
  return locate(work);
}

types::FrameReport Localizer::locate(Work& work) {
  recognise(work);
  verify(work);
  if (work.accepted) follow(work);
  if (adapt_) remember(work);
  return work.report;
}

void Localizer::restart() {
  finish();
  recogniser_.restart();
  last_ = {};
  agreeing_ = 0;
  restarted_ = true;
  gate_.restart();
}

void Localizer::move(Work& work) { reckoning_.move(work.frame.T_odom_robot); }

bool Localizer::perceive(Work& work) {
  auto features = perception_.look(work.frame, params_.recognise.accept_inliers, work.report);
  if (features) work.features = std::move(*features);
  return features.has_value();
}

void Localizer::recognise(Work& work) {
  const StepTimer timer(work.report, "recognise");
  const auto travel = restarted_ ? std::nullopt : reckoning_.travel();
  restarted_ = false;
  sinceLearning_ += reckoning_.distance();
  sinceLast_ += reckoning_.distance();
  reckoning_.markKeyframe();
  work.report.hypotheses = recogniser_.recognise(map_, work.features, travel);
  work.report.bestGuess = work.report.hypotheses.front().place;
  work.report.bestGuessInterpolated = recogniser_.interpolatedPeak();
}

/// What the belief proposes, in the order of the posterior, until one is accepted (A-18, A-E13); then what
/// geometry alone may find (K-15, K-21).
void Localizer::verify(Work& work) {
  const StepTimer timer(work.report, "verify");
  work.report.outcome = types::Outcome::kRefused;
  work.report.reason = "no place is probable enough";
  for (auto& hypothesis : candidatesOf(work.report.hypotheses, params_.recognise)) {
    if (recogniser_.neighbourhoodMass(hypothesis.place) < params_.belief.accept_threshold) continue;
    if (tryPlace(work, hypothesis, params_.recognise.accept_inliers)) return;
    work.report.reason = "the geometry does not confirm the most probable place";
  }
  if (params_.recognise.sure_inliers <= 0) return;
  auto similar = recogniser_.mostSimilar();
  if (!similar) return;
  if (tryPlace(work, *similar, params_.recognise.sure_inliers)) {
    recogniser_.confirm(similar->place);
    work.report.bestGuess = similar->place;
  }
  noteInliers(work.report.hypotheses, *similar);
}

/// Accepts a place if so many matches are verified and the rest of the evidence suffices as well.
bool Localizer::tryPlace(Work& work, types::Hypothesis& hypothesis, int inliers) {
  const PlaceMatch& match = recogniser_.match(map_, work.features, hypothesis.place);
  hypothesis.inliers = static_cast<int>(match.matches.size());
  if (hypothesis.inliers < inliers || !strongEnough(match, params_.recognise) ||
      !believable(hypothesis.place, match))
    return false;
  work.report.outcome = types::Outcome::kRecognised;
  work.report.reason.clear();
  work.report.place = hypothesis.place;
  work.accepted = match;
  return true;
}

/// Counts how long the accepted places have told one story.
void Localizer::follow(Work& work) {
  agreeing_ = last_.valid() && agreesWithMotion(work.report.place) ? agreeing_ + 1 : 1;
  last_ = work.report.place;
  gate_.accepted(last_);
  sinceLast_ = 0.0;
  if (const auto& T_place_robot = work.accepted->T_place_robot)
    return reckoning_.reset(T_place_robot->T_a_b, T_place_robot->cov);
  const double extent = params_.place.spacing;
  reckoning_.reset(Eigen::Isometry3d(work.accepted->R_place_view),
                   planarCovariance(extent, extent, 0.05, params_.odometry.sigma_floor));
}

/// A leap through the map needs as much evidence as a loop closure.
bool Localizer::believable(base::PlaceId place, const PlaceMatch& match) const {
  return !last_.valid() || agreesWithMotion(place) ||
         static_cast<int>(match.matches.size()) >= params_.recognise.closure_inliers;
}

/// Can the robot have come from the last accepted place to this one?
bool Localizer::agreesWithMotion(base::PlaceId place) const {
  if (!reckoning_.anchored()) return map_.hopDistances(last_, params_.place.recent_hops).count(place) > 0;
  const Eigen::Isometry3d T_map_robot = map_.place(last_).T_map_place * reckoning_.anchorToRobot().T_a_b;
  const double distance = (map_.place(place).T_map_place.translation() - T_map_robot.translation()).norm();
  return distance <= 2.0 * params_.place.spacing + params_.odometry.max_drift * sinceLast_;
}

/// Only what was verified is learnt, and only once the places accepted before agree with it (F-E16, X-07):
/// one wrong answer that is learnt makes the next one look right. A standing robot learns once.
void Localizer::remember(Work& work) {
  const StepTimer timer(work.report, "remember");
  learnDistant(work.report);
  if (!work.accepted || agreeing_ < params_.recognise.learn_after || !gate_.open()) return;
  if (reckoning_.known() && sinceLearning_ < params_.select.min_distance) return;
  lessons_.push_back({work.report.place, std::move(work.features)});
  sinceLearning_ = 0.0;
  gate_.learnt();
}

/// A place learns when the robot has left its surroundings. Images in a row resemble each other more than any
/// remembered view: a place that learnt at once would go on being the best match as the robot drives away,
/// learn again, and draw to itself what belongs to its neighbours.
void Localizer::learnDistant(types::FrameReport& report) {
  if (lessons_.empty() || !last_.valid()) return;
  const auto near = map_.hopDistances(last_, params_.recognise.learn_hops);
  std::vector<Lesson> kept;
  for (Lesson& lesson : lessons_) {
    if (near.count(lesson.place))
      kept.push_back(std::move(lesson));
    else
      learn(lesson, report);
  }
  lessons_ = std::move(kept);
}

/// The view is matched again: the place may have learnt since.
void Localizer::learn(const Lesson& lesson, types::FrameReport& report) {
  const PlaceMatch match = recogniser_.held(lesson.view, map_.place(lesson.place).memory);
  if (!strongEnough(match, params_.recognise)) return;
  report.memory +=
      map_.remember(lesson.place, *memory_, inPlaceFrame(lesson.view, match.R_place_view), match.matches);
  report.learnt.push_back(lesson.place);
}

std::vector<base::PlaceId> Localizer::finish() {
  types::FrameReport report;
  for (const Lesson& lesson : lessons_) learn(lesson, report);
  lessons_.clear();
  return report.learnt;
}

}  // namespace engram::pipeline

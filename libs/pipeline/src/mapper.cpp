// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/mapper.h"

#include "engram/base/error.h"
#include "engram/types/se3.h"
#include "step_timer.h"
#include "thumbnail.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
namespace {

/// In known territory the robot may pass a place at this multiple of the spacing before it has left it.
constexpr double kLeaveFactor = 1.5;

/// Covariance of being exactly at a place that was just made.
const types::Matrix6d kCertain = types::Matrix6d::Identity() * 1e-12;

Eigen::Isometry3d withRotation(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = t;
  return T;
}

}  // namespace

/// What is known of the image at hand, filled step by step.
struct Mapper::Work {
  explicit Work(const types::Frame& f) : frame(f) {}
  const types::Frame& frame;
  types::Features features;
  types::FrameReport report;
  std::vector<Candidate> candidates;  // verified or not, in the order they were tried
  std::optional<Candidate> accepted;  // the place where the robot is
  bool makesPlace = false;
  bool judged = false;  // closures were judged: edges and poses of the map have followed
};

Mapper::Mapper(const PipelineParams& params, map::TopologicalMap map)
    : params_(params),
      perception_(params.camera, params.extractor),
      memory_(memory::makeMemoryModel(params.memory, params.fsh, params.multi_store)),
      gate_(params.memory),
      recogniser_(params, Recogniser::Mode::kMapping, perception_.stereo()),
      relaxer_(params.posegraph),
      reckoning_(params.odometry),
      sinceMade_(params.odometry),
      closures_(params.posegraph),
      map_(std::move(map)),
      session_(map_.nextSession()),
      frontier_(map_.empty()) {
  if (perception_.stereo() && params_.memory.memory != "static")
    throw base::ConfigError("[camera] stereo = true needs [memory] memory = static, not " +
                            params_.memory.memory +
                            ": the 3D points of a place are those that one view of it has");
  recogniser_.load(map_);
  closures_.load(map_);
}

types::FrameReport Mapper::process(const types::Frame& frame) {
  Work work(frame);
  if (!perceive(work)) return work.report;
  move(work);
  if (!select(work)) return work.report;
  recognise(work);
  verify(work);
  decide(work);
  remember(work);
  relate(work);
  relax(work);
  return work.report;
}

bool Mapper::perceive(Work& work) {
  auto features = perception_.look(work.frame, params_.recognise.accept_inliers, work.report);
  if (features) work.features = std::move(*features);
  return features.has_value();
}

void Mapper::move(Work& work) {
  reckoning_.move(work.frame.T_odom_robot);
  sinceMade_.move(work.frame.T_odom_robot);
}

/// with A-E12 by odometry; F-07 without.
bool Mapper::select(Work& work) {
  const StepTimer timer(work.report, "select");
  if (lastKeyframe_.empty()) return true;
  if (reckoning_.known()) {
    if (reckoning_.distance() >= params_.select.min_distance ||
        reckoning_.rotation() >= params_.select.min_rotation)
      return true;
    work.report.reason = "the robot has not moved";
  } else {
    const auto matches = features::match(work.features, lastKeyframe_, params_.match);
    const double s = similarity(static_cast<int>(matches.size()), static_cast<int>(lastKeyframe_.size()));
    if (s < params_.select.standing_similarity) return true;
    work.report.reason = "the image is nearly the last one";
  }
  work.report.outcome = types::Outcome::kSkipped;
  return false;
}

void Mapper::recognise(Work& work) {
  const StepTimer timer(work.report, "recognise");
  const auto travel = reckoning_.travel();
  reckoning_.markKeyframe();
  lastKeyframe_ = work.features;
  work.report.hypotheses =
      recogniser_.recognise(map_, work.features, travel, frontier_ ? recent_ : std::set<base::PlaceId>{});
  if (!work.report.hypotheses.empty()) work.report.bestGuess = work.report.hypotheses.front().place;
  work.report.bestGuessInterpolated = recogniser_.interpolatedPeak();
  work.report.newPlaceProbability = recogniser_.newPlaceProbability();
}

/// What the belief proposes, until one is accepted; then what geometry alone may find; then, while new ground
/// is covered, the places just made.
void Mapper::verify(Work& work) {
  const StepTimer timer(work.report, "verify");
  if (verifyBelieved(work) || verifySimilar(work) || !frontier_ || !anchor_.valid()) return;
  const auto nearest = nearestByOdometry();
  const base::PlaceId near = nearest ? nearest->first : anchor_;
  if (!tryPlace(work, near) && near != anchor_) tryPlace(work, anchor_, false);
}

/// Hypotheses in the order of their posterior (A-18, A-E13).
bool Mapper::verifyBelieved(Work& work) {
  for (auto& hypothesis : candidatesOf(work.report.hypotheses, params_.recognise)) {
    if (recogniser_.neighbourhoodMass(hypothesis.place) < params_.belief.accept_threshold) continue;
    const bool accepted = tryPlace(work, hypothesis.place);
    hypothesis.inliers = static_cast<int>(work.candidates.back().second.matches.size());
    if (accepted) return true;
  }
  return false;
}

/// The most similar place, while the belief is undecided: as many matches as K-15 asks need none (K-21).
bool Mapper::verifySimilar(Work& work) {
  if (params_.recognise.sure_inliers <= 0) return false;
  auto similar = recogniser_.mostSimilar();
  if (!similar) return false;
  const PlaceMatch& match = recogniser_.match(map_, work.features, similar->place);
  similar->inliers = static_cast<int>(match.matches.size());
  noteInliers(work.report.hypotheses, *similar);
  if (similar->inliers < params_.recognise.sure_inliers || !tryPlace(work, similar->place)) return false;
  recogniser_.confirm(similar->place);
  return true;
}

/// Matches the image with a place. It is accepted if the evidence suffices for what it would mean.
bool Mapper::tryPlace(Work& work, base::PlaceId id, bool mayAccept) {
  work.candidates.emplace_back(id, recogniser_.match(map_, work.features, id));
  const PlaceMatch& match = work.candidates.back().second;
  const bool enough =
      !isClosure(id) || static_cast<int>(match.matches.size()) >= params_.recognise.closure_inliers;
  if (mayAccept && enough && strongEnough(match, params_.recognise) && belongsTo(id, match))
    work.accepted = work.candidates.back();
  return work.accepted.has_value();
}

bool Mapper::isRecent(base::PlaceId place) const { return frontier_ && recent_.count(place) > 0; }

/// Where odometry puts the robot, seen from a place near the anchor.
Eigen::Isometry3d Mapper::T_place_robot(base::PlaceId place) const {
  return map_.place(place).T_map_place.inverse() * map_.place(anchor_).T_map_place *
         reckoning_.anchorToRobot().T_a_b;
}

/// The place around the anchor that is nearest to the robot by odometry, with its distance [m].
std::optional<std::pair<base::PlaceId, double>> Mapper::nearestByOdometry() const {
  if (!metric()) return std::nullopt;
  std::optional<std::pair<base::PlaceId, double>> best;
  for (const auto& [id, hops] : map_.hopDistances(anchor_, params_.place.recent_hops)) {
    const double distance = T_place_robot(id).translation().norm();
    if (!best || distance < best->second) best = {id, distance};
  }
  return best;
}

/// A place that the graph has no short way to: to recognise it adds an edge.
bool Mapper::isClosure(base::PlaceId place) const {
  return anchor_.valid() && map_.hopDistances(anchor_, params_.place.recent_hops).count(place) == 0;
}

/// Whether a verified view is still of this place, or of a new one beside it (F-07).
bool Mapper::belongsTo(base::PlaceId place, const PlaceMatch& match) const {
  if (!anchor_.valid()) return true;
  if (!metric()) return !isRecent(place) || match.similarity >= params_.place.same_similarity;
  const double limit = params_.place.spacing * (frontier_ ? 1.0 : kLeaveFactor);
  return isClosure(place) || T_place_robot(place).translation().norm() < limit;
}

/// Recognised, new, or refused. A loop closure enters only if the graph does not deny it.
void Mapper::decide(Work& work) {
  auto& report = work.report;
  if (work.accepted && isClosure(work.accepted->first) && metric()) {
    const auto decision = closures_.propose(map_, closureTo(work, *work.accepted));
    applyJudgement(work);
    if (!decision.accepted) refuse(work, decision.reason);
  }
  if (work.accepted) {
    report.outcome = types::Outcome::kRecognised;
    report.place = work.accepted->first;
    misses_ = 0;
    return;
  }
  if (map_.empty()) {
    work.makesPlace = true;
  } else if (!anchor_.valid() || (!metric() && !frontier_)) {  // somewhere in the map, or off it
    const bool offTheMap = anchor_.valid() && report.newPlaceProbability >= params_.belief.accept_threshold;
    work.makesPlace = offTheMap || ++misses_ >= params_.place.patience;
    if (report.reason.empty()) report.reason = "not localised in the map yet";
  } else if (metric()) {
    const auto nearest = nearestByOdometry();
    work.makesPlace = nearest->second >= params_.place.spacing * (frontier_ ? 1.0 : kLeaveFactor);
    if (report.reason.empty()) report.reason = "odometry says a known place, the image does not";
  } else {
    work.makesPlace = true;
  }
  report.outcome = work.makesPlace ? types::Outcome::kNewPlace : types::Outcome::kRefused;
  if (work.makesPlace) report.reason.clear();
}

void Mapper::refuse(Work& work, posegraph::ClosureReason reason) const {
  work.report.reason = "the graph refuses the closure to place " +
                       std::to_string(work.accepted->first.value) + ": " + posegraph::toString(reason);
  work.accepted.reset();
}

void Mapper::remember(Work& work) {
  if (work.report.outcome == types::Outcome::kRefused) return;
  const StepTimer timer(work.report, "remember");
  if (work.makesPlace) return addPlace(work);

  const auto& [id, match] = *work.accepted;
  gate_.accepted(id);
  if (gate_.open()) {
    work.report.learnt = {id};
    work.report.memory =
        map_.remember(id, *memory_, inPlaceFrame(work.features, match.R_place_view), match.matches);
    gate_.learnt();
  }
  addView(work, id, 0);
}

void Mapper::relate(Work& work) {
  const StepTimer timer(work.report, "relate");
  if (work.accepted) joinPlace(work, *work.accepted);
  if (!anchor_.valid()) return;
  map_.addPathPoint({session_, work.frame.stamp, anchor_,
                     metric() ? reckoning_.anchorToRobot().T_a_b : Eigen::Isometry3d::Identity()});
}

/// A new node with its edge to where the robot came from (F-05, F-07, A-03).
void Mapper::addPlace(Work& work) {
  const base::PlaceId from = cameFrom();
  map::Place place;
  if (from.valid()) place.T_map_place = map_.place(from).T_map_place * motionFrom(work, from).T_a_b;
  place.memory = memory_->start(work.features);
  place.createdStamp = work.frame.stamp;
  place.createdIndex = work.frame.index;
  place.createdLabel = work.frame.label;
  place.session = session_;
  work.report.memory.longTerm = static_cast<int>(place.memory.longTerm().size());
  work.report.memory.shortTerm = static_cast<int>(place.memory.features.size()) - work.report.memory.longTerm;
  work.report.memory.added = static_cast<int>(place.memory.features.size());
  const base::PlaceId made = work.report.place = map_.addPlace(std::move(place));
  work.report.learnt = {made};
  addView(work, made, params_.place.keep_thumbnails);
  gate_.accepted(made);
  gate_.learnt();

  if (from.valid()) addEdges(work, from, made);
  anchor_ = made_ = made;
  anchoredBy_ = {};
  reckoning_.reset(Eigen::Isometry3d::Identity(), kCertain);
  sinceMade_.reset(Eigen::Isometry3d::Identity(), kCertain);
  frontier_ = true;
  misses_ = 0;
  recent_.insert(made);
  const auto near = map_.hopDistances(made, params_.place.recent_hops);
  std::erase_if(recent_, [&](base::PlaceId id) { return !near.contains(id); });
}

/// The place that a new one is joined to: the anchor, or at wake-up the last one of the map (K-19).
base::PlaceId Mapper::cameFrom() const {
  return anchor_.valid() || map_.empty() ? anchor_ : map_.places().rbegin()->first;
}

/// A robot that leaves known ground is where it is because an image was recognised there: that edge may be
/// false, as a closure may. What the wheels say since the last place of this drive does not depend on it.
void Mapper::addEdges(const Work& work, base::PlaceId from, base::PlaceId place) {
  map::Edge edge;
  edge.a = from;
  edge.b = place;
  edge.T_a_b = motionFrom(work, edge.a);
  edge.type = anchor_.valid() ? map::EdgeType::kOdometry : map::EdgeType::kWeak;
  for (const auto& [id, match] : work.candidates)
    if (id == edge.a && match.verified()) edge.correspondences = correspondences(match, edge.a, edge.b);
  const bool rests = anchor_.valid() && metric() && !frontier_;
  if (rests) edge.type = closureType(edge.a);
  edge.id = map_.addEdge(edge);
  if (!rests) return;
  closures_.enter(edge);
  if (!made_.valid() || !sinceMade_.anchored()) return;
  const types::RelPose& counted = sinceMade_.anchorToRobot();
  const bool neighbours = counted.T_a_b.translation().norm() <= kLeaveFactor * 2 * params_.place.spacing;
  map::Edge wheels;
  wheels.a = made_;
  wheels.b = place;
  wheels.type = neighbours ? map::EdgeType::kOdometry : map::EdgeType::kDeadReckoning;
  wheels.T_a_b = counted;
  map_.addEdge(std::move(wheels));
}

map::EdgeType Mapper::closureType(base::PlaceId to) const {
  return map_.place(to).session == session_ ? map::EdgeType::kLoop : map::EdgeType::kRecognition;
}

/// Relative pose of the new place: by odometry; else the direction of the two-view geometry, one spacing long
/// (F-05: planar motion up to scale).
types::RelPose Mapper::motionFrom(const Work& work, base::PlaceId from) const {
  if (metric() && from == anchor_) return reckoning_.anchorToRobot();
  const double spacing = params_.place.spacing;
  types::RelPose guess;
  guess.T_a_b.translation().x() = anchor_.valid() ? spacing : 0.0;
  guess.cov = planarCovariance(spacing, spacing, 1.0, params_.odometry.sigma_floor);
  for (const auto& [id, match] : work.candidates)
    if (id == from && match.verified())
      guess.T_a_b = withRotation(match.R_place_view, spacing * match.direction_place);
  return guess;
}

void Mapper::addView(const Work& work, base::PlaceId place, int thumbnailWidth) {
  map::View view;
  view.place = place;
  view.stamp = work.frame.stamp;
  view.frameIndex = work.frame.index;
  view.label = work.frame.label;
  view.session = session_;
  if (thumbnailWidth > 0) view.jpeg = thumbnail(work.frame.image, thumbnailWidth);
  map_.addView(std::move(view));
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> Mapper::correspondences(const PlaceMatch& match,
                                                                             base::PlaceId a,
                                                                             base::PlaceId b) const {
  const auto& statesA = map_.place(a).memory.states;
  const auto& statesB = map_.place(b).memory.states;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& m : match.matches) {
    // A fresh memory numbers its features as they come in the view, without those it found to be duplicates.
    const auto id = static_cast<std::uint32_t>(m.a);
    const bool kept = std::any_of(statesB.begin(), statesB.end(), [id](const auto& s) { return s.id == id; });
    if (kept) pairs.emplace_back(statesA[static_cast<std::size_t>(m.b)].id, id);
  }
  return pairs;
}

/// Where the robot is, seen from the place that it is recognised at: at the place itself, unless
/// odometry knows better.
types::RelPose Mapper::atPlace(const Candidate& candidate) const {
  const auto& [id, match] = candidate;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  if (metric() && !isClosure(id)) {
    offset = T_place_robot(id).translation();
    offset *= std::min(1.0, 0.5 * params_.place.spacing / std::max(1e-9, offset.norm()));
  }
  types::RelPose T_place_robot;
  T_place_robot.T_a_b = withRotation(match.R_place_view, offset);
  const double extent = 0.5 * params_.place.spacing;
  T_place_robot.cov = planarCovariance(extent, extent, 0.05, params_.odometry.sigma_floor);
  return T_place_robot;
}

map::Edge Mapper::closureTo(const Work& work, const Candidate& candidate) const {
  map::Edge edge;
  edge.type = closureType(candidate.first);
  edge.a = anchor_;
  edge.b = candidate.first;
  edge.T_a_b = types::compose(motionFrom(work, anchor_), types::inverse(atPlace(candidate)));
  return edge;
}

/// The robot is back at a known place: a closing edge where the graph had no short way, and a new anchor.
void Mapper::joinPlace(Work& work, const Candidate& candidate) {
  const base::PlaceId id = candidate.first;
  if (isRecent(id) && metric()) return;  // odometry since the anchor is better than the place's extent

  const types::RelPose T_place_robot = atPlace(candidate);
  if (!work.judged && isClosure(id)) {  // no odometry that could deny it
    map_.addEdge(closureTo(work, candidate));
    map::dropJoinedWeakEdges(map_, parts_);
    work.report.closure = closedUnmetric_ = true;
  }
  anchor_ = id;
  frontier_ = false;
  recent_.clear();
  reckoning_.reset(T_place_robot.T_a_b, T_place_robot.cov);
}

/// Edges and poses follow the judgement over all closures. A robot whose anchor rested on one that is denied
/// goes back to what the wheels say since the place it made last.
void Mapper::applyJudgement(Work& work) {
  const ClosureBook::Changes changes = closures_.apply(map_);
  work.judged = true;
  work.report.closure = changes.proposed.valid();
  work.report.closuresDropped = static_cast<int>(changes.dropped.size());
  work.report.closuresRestored = changes.restored;
  if (std::count(changes.dropped.begin(), changes.dropped.end(), anchoredBy_) > 0 && made_.valid()) {
    anchor_ = made_;
    reckoning_ = sinceMade_;
    anchoredBy_ = {};
    frontier_ = true;
  }
  if (changes.proposed.valid()) anchoredBy_ = changes.proposed;
  map::dropJoinedWeakEdges(map_, parts_);
}

/// The judgement over closures has relaxed the whole graph already; a place with more than one edge asks for
/// its surroundings.
void Mapper::relax(Work& work) {
  const StepTimer timer(work.report, "relax");
  if (std::exchange(closedUnmetric_, false)) relaxer_.all(map_);
  if (work.makesPlace && map_.neighbours(anchor_).size() > 1) relaxer_.around(map_, anchor_);
}

void Mapper::finish() {
  gate_.restart();
  if (closures_.empty()) return relaxer_.all(map_);
  closures_.review(map_);
  closures_.apply(map_);
}

}  // namespace engram::pipeline

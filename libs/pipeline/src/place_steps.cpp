// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_steps.h"

#include "drive_edges.h"
#include "place_lessons.h"
#include "place_rules.h"
#include "step_timer.h"
#include "thumbnail.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace engram::pipeline {
namespace {

/// Covariance of being exactly at a place that was just made.
const types::Matrix6d kCertain = types::Matrix6d::Identity() * 1e-12;

std::unique_ptr<memory::MemoryModel> modelOf(const PipelineParams& params) {
  return memory::makeMemoryModel(params.memory, params.fsh, params.multi_store);
}

/// Edges and poses follow the judgement over all closures. A robot whose anchor rested on one that is denied
/// goes back to what the wheels say since the place it made last.
/// @param rests the robot is where the proposed closure says
void applyJudgement(Run& run, bool rests, types::FrameReport& report) {
  const ClosureBook::Changes changes = run.closures.apply(run.map);
  const bool entered = changes.proposed.valid();
  report.closure = report.closure || (rests && entered);
  report.closuresDropped += static_cast<int>(changes.dropped.size());
  report.closuresRestored += changes.restored + (!rests && entered);
  run.robot.deny(changes.dropped);
  if (rests && changes.proposed.valid()) run.robot.restOn(changes.proposed);
  map::dropJoinedWeakEdges(run.map, run.parts);
}

}  // namespace

base::PlaceId cameFrom(const Run& run, base::PlaceId made) {
  if (run.robot.anchor().valid()) return run.robot.anchor();
  const auto& places = run.map.places();
  const auto end = made.valid() ? places.find(made) : places.end();
  return end == places.begin() ? base::PlaceId() : std::prev(end)->first;
}

base::PlaceId addNode(Run& run, const Keyframe& image, const Eigen::Isometry3d& T_map_place,
                      memory::PlaceMemory memory) {
  map::Place place;
  place.T_map_place = T_map_place;
  place.memory = std::move(memory);
  place.createdStamp = image.frame.stamp;
  place.createdIndex = image.frame.index;
  place.createdLabel = image.frame.label;
  place.session = run.session;
  const base::PlaceId made = run.map.addPlace(std::move(place));
  addView(run, image, made, run.params.place.keep_thumbnails);
  return made;
}

void addView(Run& run, const Keyframe& image, base::PlaceId place, int thumbnailWidth) {
  map::View view{.place = place,
                 .stamp = image.frame.stamp,
                 .frameIndex = image.frame.index,
                 .label = image.frame.label,
                 .session = run.session};
  if (thumbnailWidth > 0) view.jpeg = thumbnail(image.picture, thumbnailWidth);
  run.map.addView(std::move(view));
}

Decision PlaceDecide::decide(Run& run, const Keyframe&, const Verified& verified,
                             types::FrameReport& report) {
  Decision decision{.known = verified.accepted};
  if (decision.known && isClosure(run, decision.known->place) && run.robot.metric())
    judge(run, verified, decision, report);
  if (decision.known) {
    decision.T_known_robot = atPlace(run, *decision.known);
    judgeEchoes(run, verified.echoes, decision.known->place, decision.T_known_robot, report);
    report.outcome = types::Outcome::kRecognised;
    report.acceptedBy = types::AcceptedBy::kGeometry;
    report.place = decision.known->place;
    misses_ = 0;
    return decision;
  }
  if (verified.doubtful) run.robot.doubt();
  if (const auto motion = run.robot.motion())
    judgeEchoes(run, verified.echoes, run.robot.anchor(), *motion, report);
  const bool knownGround = run.robot.anchor().valid() && !run.robot.frontier();
  decision.makesNode = isNew(run, report) && !(verified.doubtful && knownGround);
  report.outcome = decision.makesNode ? types::Outcome::kNewPlace : types::Outcome::kRefused;
  if (decision.makesNode) {
    report.reason.clear();
    misses_ = 0;
  }
  return decision;
}

void PlaceDecide::judge(Run& run, const Verified& verified, Decision& decision,
                        types::FrameReport& report) const {
  const auto judged = run.closures.propose(run.map, closureTo(run, *decision.known, verified.links));
  applyJudgement(run, true, report);
  decision.judged = true;
  if (judged.accepted) return;
  report.reason = "the graph refuses the closure to place " + std::to_string(decision.known->place.value) +
                  ": " + posegraph::toString(judged.reason);
  decision.known.reset();
}

void PlaceDecide::judgeEchoes(Run& run, std::span<const Link> echoes, base::PlaceId here,
                              const types::RelPose& T_here_robot, types::FrameReport& report) const {
  for (const Link& echo : echoes) {
    run.closures.propose(run.map, closureBetween(run, here, T_here_robot, echo));
    applyJudgement(run, false, report);
  }
}

bool PlaceDecide::isNew(const Run& run, types::FrameReport& report) {
  if (run.map.empty()) return true;
  const bool anchored = run.robot.anchor().valid(), metric = run.robot.metric();
  const auto because = [&](const char* reason) {
    if (report.reason.empty()) report.reason = reason;
  };
  if (!anchored || (!metric && !run.robot.frontier())) {  // somewhere in the map, or off it
    because("not localised in the map yet");
    const bool offTheMap = anchored && report.newPlaceProbability >= run.params.belief.accept_threshold;
    return offTheMap || ++misses_ >= run.params.place.patience;
  }
  if (!metric) return true;
  because("odometry says a known place, the image does not");
  return nearestByOdometry(run)->second >= spacingHere(run);
}

Decision KnownDecide::decide(Run& run, const Keyframe&, const Verified& verified,
                             types::FrameReport& report) {
  Decision decision{.known = verified.accepted};
  const bool bySequence = !decision.known && verified.bySequence.valid();
  report.outcome = decision.known || bySequence ? types::Outcome::kRecognised : types::Outcome::kRefused;
  report.acceptedBy = decision.known ? types::AcceptedBy::kGeometry
                      : bySequence   ? types::AcceptedBy::kSequence
                                     : types::AcceptedBy::kNothing;
  report.reason = decision.known || bySequence ? "" : verified.reason;
  report.place = verified.bySequence;
  if (!decision.known) {  // a sequence tells the place, and neither a pose nor a lesson
    if (verified.doubtful) run.robot.doubt();
    return decision;
  }
  report.place = decision.known->place;
  decision.T_known_robot = atPlace(run, *decision.known);
  decision.agrees = run.robot.anchor().valid() && agreesWithMotion(run, report.place);
  return decision;
}

PlaceRemember::PlaceRemember(const Run& run) : memory_(modelOf(run.params)), gate_(run.params.memory) {}

base::PlaceId PlaceRemember::remember(Run& run, const Keyframe& image, const Verified& verified,
                                      const Decision& decision, types::FrameReport& report) {
  if (!decision.known && !decision.makesNode) return {};
  const StepTimer timer(report, "remember");
  if (decision.makesNode) return newPlace(run, image, verified, report);
  const base::PlaceId id = decision.known->place;
  const PlaceMatch& match = decision.known->match;
  measureFrom(run, image.features, *decision.known, decision.T_known_robot);
  gate_.accepted(id);
  if (gate_.open()) {
    report.learnt = {id};
    report.memory = teach(run, *memory_, {id, image.features, decision.T_known_robot}, match);
    gate_.learnt();
  }
  addView(run, image, id, 0);
  return {};
}

/// A new node (F-05, F-07, A-03).
base::PlaceId PlaceRemember::newPlace(Run& run, const Keyframe& image, const Verified& verified,
                                      types::FrameReport& report) {
  const base::PlaceId from = cameFrom(run);
  Eigen::Isometry3d T_map_place = Eigen::Isometry3d::Identity();
  if (from.valid())
    T_map_place = run.map.place(from).T_map_place * motionFrom(run, from, verified.links).T_a_b;
  memory::PlaceMemory memory = memory_->start(image.features);
  report.memory.added = static_cast<int>(memory.features.size());
  report.memory.longTerm = static_cast<int>(memory.longTerm().size());
  report.memory.shortTerm = report.memory.added - report.memory.longTerm;
  report.place = addNode(run, image, T_map_place, std::move(memory));
  measureWith(run, image.features, verified, report.place);
  report.learnt = {report.place};
  gate_.accepted(report.place);
  gate_.learnt();
  return report.place;
}

std::vector<base::PlaceId> PlaceRemember::finish(Run&) {
  gate_.restart();
  return {};
}

LaterRemember::LaterRemember(const Run& run)
    : memory_(modelOf(run.params)),
      gate_(run.params.memory),
      sinceLearning_(std::numeric_limits<double>::infinity()) {}

base::PlaceId LaterRemember::remember(Run& run, const Keyframe& image, const Verified&,
                                      const Decision& decision, types::FrameReport& report) {
  const StepTimer timer(report, "remember");
  sinceLearning_ += image.distance;
  if (decision.known) gate_.accepted(decision.known->place);
  learnDistant(run, decision.known ? decision.known->place : run.robot.anchor(), report);
  const int agreeing = decision.agrees ? run.robot.agreeing() + 1 : 1;
  if (!decision.known || agreeing < run.params.recognise.learn_after || !gate_.open()) return {};
  if (run.robot.sinceKeyframe().known() && sinceLearning_ < run.params.select.min_distance) return {};
  lessons_.push_back({decision.known->place, image.features, decision.T_known_robot});
  sinceLearning_ = 0.0;
  gate_.learnt();
  return {};
}

void LaterRemember::learnDistant(Run& run, base::PlaceId here, types::FrameReport& report) {
  if (lessons_.empty() || !here.valid()) return;
  const auto near = run.map.hopDistances(here, run.params.recognise.learn_hops);
  std::vector<Lesson> kept;
  for (Lesson& lesson : lessons_) {
    if (near.contains(lesson.place))
      kept.push_back(std::move(lesson));
    else
      learn(run, lesson, report);
  }
  lessons_ = std::move(kept);
}

/// The view is matched again: the place may have learnt since.
void LaterRemember::learn(Run& run, const Lesson& lesson, types::FrameReport& report) const {
  const PlaceMatch match =
      heldAgainst(lesson.view, run.map.place(lesson.place).memory, run.params, run.perception.stereo());
  if (!strongEnough(match, run.params.recognise)) return;
  report.memory += teach(run, *memory_, lesson, match);
  report.learnt.push_back(lesson.place);
}

std::vector<base::PlaceId> LaterRemember::finish(Run& run) {
  types::FrameReport report;
  for (const Lesson& lesson : lessons_) learn(run, lesson, report);
  lessons_.clear();
  return report.learnt;
}

Relation PlaceRelate::relate(Run& run, const Keyframe& image, const Verified& verified,
                             const Decision& decision, base::PlaceId node, types::FrameReport& report) {
  const StepTimer timer(report, "relate");
  Relation relation{.node = node};
  if (node.valid()) {
    joinNew(run, verified, node);
    run.robot.made(node, image.frame.stamp, kCertain);
    run.robot.keepRecent(run.map, run.params.place.recent_hops);
  } else if (decision.known) {
    relation.unmetric = joinKnown(run, verified, decision, report);
  }
  const base::PlaceId anchor = run.robot.anchor();
  if (!anchor.valid()) return relation;
  const auto motion = run.robot.motion();
  run.map.addPathPoint(
      {run.session, image.frame.stamp, anchor, motion ? motion->T_a_b : Eigen::Isometry3d::Identity()});
  return relation;
}

/// A robot that leaves known ground is where it is because an image was recognised there: that edge may be
/// false, as a closure may. What the wheels say since the last place of this drive does not depend on it.
void PlaceRelate::joinNew(Run& run, const Verified& verified, base::PlaceId node) const {
  const bool anchored = run.robot.anchor().valid();
  const bool rests = anchored && run.robot.metric() && !run.robot.frontier();
  map::Edge edge{.type = anchored ? map::EdgeType::kOdometry : map::EdgeType::kWeak, .b = node};
  edge.a = cameFrom(run, node);
  if (!edge.a.valid()) return;
  if (run.robot.strayed() && !seesWay(edge.a, verified.links)) edge.type = map::EdgeType::kWeak;
  edge.T_a_b = motionFrom(run, edge.a, verified.links);
  for (const Link& link : verified.links)
    if (link.place == edge.a && link.match.verified())
      edge.correspondences = correspondences(run, link.match, edge.a, edge.b);
  if (rests) edge.type = closureType(run, edge.a);
  if (!rests) watchOdometry(run, verified.links);
  edge.id = run.map.addEdge(edge);
  if (!rests) return;
  run.closures.enter(edge);
  const DeadReckoning& wheels = run.robot.sinceMade();
  if (!run.robot.lastMade().valid() || !wheels.anchored()) return;
  const types::RelPose& counted = wheels.anchorToRobot();
  const bool near = counted.T_a_b.translation().norm() <= kLeaveFactor * 2 * run.params.place.spacing;
  run.map.addEdge({.type = near ? map::EdgeType::kOdometry : map::EdgeType::kDeadReckoning,
                   .a = run.robot.lastMade(),
                   .b = node,
                   .T_a_b = counted});
}

/// True when a closure entered that no odometry could deny.
bool PlaceRelate::joinKnown(Run& run, const Verified& verified, const Decision& decision,
                            types::FrameReport& report) const {
  const Link& link = *decision.known;
  const bool recent = run.robot.frontier() && run.robot.recent().contains(link.place);
  if (recent && run.robot.metric()) return false;  // odometry since the anchor is better than the extent
  const bool unjudged = !decision.judged && isClosure(run, link.place);
  if (unjudged) {
    run.map.addEdge(closureTo(run, link, verified.links));
    map::dropJoinedWeakEdges(run.map, run.parts);
    report.closure = true;
  }
  run.robot.backAt(link.place, decision.T_known_robot);
  holdToMap(run, link);
  return unjudged;
}

Relation FollowRelate::relate(Run& run, const Keyframe&, const Verified&, const Decision& decision,
                              base::PlaceId, types::FrameReport&) {
  if (!decision.known) return {};
  run.robot.backAt(decision.known->place, decision.T_known_robot, decision.agrees);
  return {};
}

void PlaceRelax::relax(Run& run, const Relation& relation, types::FrameReport& report) {
  const StepTimer timer(report, "relax");
  if (relation.unmetric) relaxer_.all(run.map);
  if (relation.node.valid() && run.map.neighbours(relation.node).size() > 1)
    relaxer_.around(run.map, relation.node);
}

void PlaceRelax::finish(Run& run) {
  agreeOnTheMetre(run, firstEdge_);
  if (run.closures.empty()) return relaxer_.all(run.map);
  run.closures.review(run.map);
  run.closures.apply(run.map);
}

}  // namespace engram::pipeline

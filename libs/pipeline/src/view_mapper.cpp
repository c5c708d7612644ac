// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/view_mapper.h"

#include "engram/base/error.h"
#include "engram/base/parallel.h"
#include "engram/types/se3.h"
#include "step_timer.h"
#include "thumbnail.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
namespace {

/// The whole map is relaxed at most once while it grows by this share.
constexpr std::size_t kRelaxShare = 4;

/// To views that the graph has near, a link must agree better than to others: within this share.
constexpr double kNearShare = 0.4;

const types::RelPose kHere{.cov = types::Matrix6d::Zero()};

odometry::StereoOdometry makeOdometry(const Perception& perception, const PipelineParams& params) {
  if (!perception.stereo())
    throw base::ConfigError(
        "[mapping] nodes = views needs both eyes of a stereo camera: set [camera] stereo = true and file to "
        "its calibration");
  if (params.memory.memory != "static")
    throw base::ConfigError("[mapping] nodes = views needs [memory] memory = static, not " +
                            params.memory.memory + ": a view is kept or forgotten as a whole");
  return {perception.stereo()->model, perception.rectifiedMask(), params.visual_odometry};
}

}  // namespace

types::Features viewFeatures(const Perception& perception, const types::StereoPair& pair, int most) {
  const types::Features all = perception(pair);
  std::vector<int> kept;
  for (std::size_t i = 0; i < all.size() && kept.size() < static_cast<std::size_t>(most); ++i)
    if (all.ranges[i] > 0) kept.push_back(static_cast<int>(i));
  return all.subset(kept);
}

/// What is known of the image at hand, filled step by step.
struct ViewMapper::Work {
  explicit Work(const types::Frame& f) : frame(f) {}
  const types::Frame& frame;
  types::StereoPair pair;
  odometry::OdometryResult seen;         // by visual odometry
  std::optional<types::RelPose> motion;  // since the anchor, measured
  types::Features features;
  types::FrameReport report;
  std::vector<base::PlaceId> tried;   // views that the image was held against
  std::vector<Link> links;            // those that geometry confirms, best first
  base::PlaceId view;                 // that the image became
  std::vector<base::EdgeId> edges;    // that are new
  std::map<base::PlaceId, int> near;  // views that the graph has near already: a link to others is a closure
  bool joined = false;                // parts of the map that nothing measured had joined before
};

ViewMapper::ViewMapper(const PipelineParams& params, map::TopologicalMap map)
    : params_(params),
      perception_(params.camera, params.extractor),
      odometry_(makeOdometry(perception_, params)),
      search_(params),
      relaxer_(params.posegraph),
      map_(std::move(map)),
      budget_(params.upkeep.budget(params.stereo.min_inliers)),
      session_(map_.nextSession()),
      wheels_(params.odometry) {
  search_.load(map_);
}

ViewMapper::~ViewMapper() = default;

/// K-19. A view that odometry could not join to the last one is taken up once the next image confirms it: a
/// run of failures leaves one view and one weak link (K-E10).
types::FrameReport ViewMapper::process(const types::Frame& frame) {
  Work work(frame);
  if (!perceive(work)) return work.report;
  if (!move(work)) return work.report;
  if (!select(work)) return work.report;
  if (!describe(work)) return work.report;
  recognise(work);
  verify(work);
  remember(work);
  relate(work);
  forget(work);
  relax(work);
  return work.report;
}

bool ViewMapper::perceive(Work& work) {
  const StepTimer timer(work.report, "perceive");
  auto& report = work.report;
  report.index = work.frame.index;
  report.stamp = work.frame.stamp;
  report.label = work.frame.label;
  report.outcome = types::Outcome::kUnusable;
  report.reason = perception_.refusal(work.frame);
  if (!report.reason.empty()) return false;
  work.pair = perception_.rectified(work.frame);
  check_.add(work.pair);
  return true;
}

/// Steps 3 and 4: visual odometry against the last keyframe; where it fails the robot is lost (K-E10).
bool ViewMapper::move(Work& work) {
  const StepTimer timer(work.report, "move");
  wheels_.move(work.frame.T_odom_robot);
  work.seen = odometry_.process(work.pair, eyeStep(work.frame));
  work.report.features = work.seen.points;
  if (!work.seen.ok()) {
    lost_ = true;
    if (work.seen.reason == odometry::OdometryReason::kFirst) work.report.outcome = types::Outcome::kSkipped;
    work.report.reason = whyLost(work.seen.reason);
    return false;
  }
  if (lost_) return true;
  const auto T_anchor_robot =
      types::compose(T_anchor_keyframe_, perception_.stereo()->ofRobot(work.seen.T_keyframe_now));
  if (tooFast(work, T_anchor_robot)) {
    lost_ = true;
    odometry_.reset();
    work.report.reason = "visual odometry failed: it says that the robot is faster than it can be";
    return false;
  }
  T_anchor_robot_ = T_anchor_robot;
  stamp_ = work.frame.stamp;
  if (work.seen.newKeyframe) T_anchor_keyframe_ = T_anchor_robot_;
  return true;
}

bool ViewMapper::tooFast(const Work& work, const types::RelPose& T_anchor_robot) const {
  const double moved = (T_anchor_robot_.T_a_b.inverse() * T_anchor_robot.T_a_b).translation().norm();
  return moved > params_.views.max_speed * std::max(0.1, std::abs(work.frame.stamp - stamp_));
}

/// The motion of the left eye since the last image by the wheels: it tells odometry where to look.
std::optional<Eigen::Isometry3d> ViewMapper::eyeStep(const types::Frame& frame) {
  const auto last = std::exchange(T_odom_last_, frame.T_odom_robot);
  if (!last || !frame.T_odom_robot) return std::nullopt;
  const Eigen::Isometry3d& T_robot_eye = perception_.stereo()->T_robot_cam;
  return T_robot_eye.inverse() * last->inverse() * *frame.T_odom_robot * T_robot_eye;
}

std::string ViewMapper::whyLost(odometry::OdometryReason reason) const {
  if (reason == odometry::OdometryReason::kFirst) return "the first image";
  std::string why = std::string("visual odometry failed: ") + odometry::toString(reason);
  const odometry::StereoHealth health = check_.health();
  if (!health.ok() && health.fault != odometry::StereoFault::kUnknown)
    why += "; " + odometry::describe(health);
  return why;
}

/// K-20: a view when the keyframe changes, but not too often. A lost robot takes the first image that it can
/// join to the next; odometry goes on from there.
bool ViewMapper::select(Work& work) {
  const StepTimer timer(work.report, "select");
  work.report.outcome = types::Outcome::kSkipped;
  if (lost_) {
    odometry_.reset();
    return odometry_.process(work.pair).newKeyframe;
  }
  const double since = work.frame.stamp - anchorStamp_;
  if (work.seen.newKeyframe && (since < 0 || since >= params_.views.min_interval)) return true;
  work.report.reason = work.seen.newKeyframe ? "a view was taken shortly before" : "the robot has not moved";
  return false;
}

bool ViewMapper::describe(Work& work) {
  const StepTimer timer(work.report, "describe");
  work.features = viewFeatures(perception_, work.pair, params_.views.max_features);
  work.report.features = static_cast<int>(work.features.size());
  if (work.report.features >= params_.stereo.min_inliers) return true;
  work.report.reason = "too few features whose range is known";
  return false;
}

void ViewMapper::recognise(Work& work) {
  const StepTimer timer(work.report, "recognise");
  work.motion = motionSinceAnchor();
  search_.follow(map_);
  for (const auto& [view, score] : search_.find(work.features)) {
    types::Hypothesis hypothesis;
    hypothesis.place = view;
    hypothesis.similarity = score;
    work.report.hypotheses.push_back(hypothesis);
    work.tried.push_back(view);
  }
  if (work.motion && std::find(work.tried.begin(), work.tried.end(), anchor_) == work.tried.end())
    work.tried.push_back(anchor_);
}

/// All views that geometry confirms, not the best alone (K-05).
void ViewMapper::verify(Work& work) {
  const StepTimer timer(work.report, "verify");
  std::vector<std::optional<Link>> links(work.tried.size());
  base::parallelFor(links.size(), params_.recognise.threads,
                    [&](std::size_t i) { links[i] = linkTo(work, work.tried[i]); });
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (i < work.report.hypotheses.size())
      work.report.hypotheses[i].inliers = links[i] ? static_cast<int>(links[i]->match.matches.size()) : 0;
    if (links[i]) work.links.push_back(std::move(*links[i]));
  }
  std::stable_sort(work.links.begin(), work.links.end(), [](const Link& a, const Link& b) {
    return a.match.matches.size() > b.match.matches.size();
  });
  if (!work.links.empty()) work.report.bestGuess = work.links.front().to;
}

std::optional<ViewMapper::Link> ViewMapper::linkTo(const Work& work, base::PlaceId view) const {
  Link link{view, matchToPlace(work.features, map_.place(view).memory, params_.match, params_.stereo,
                               *perception_.stereo())};
  if (!link.match.verified()) return std::nullopt;
  link.match.T_place_robot = floored(*link.match.T_place_robot);
  return link;
}

/// Step 5.b.i: the image becomes a view of the map.
void ViewMapper::remember(Work& work) {
  const StepTimer timer(work.report, "remember");
  map::Place place;
  place.T_map_place = types::rigid(guessedPose(work));
  place.memory = memory_.start(work.features);
  place.createdStamp = work.frame.stamp;
  place.createdIndex = work.frame.index;
  place.createdLabel = work.frame.label;
  place.session = session_;
  work.view = map_.addPlace(std::move(place));

  map::View view{.place = work.view,
                 .stamp = work.frame.stamp,
                 .frameIndex = work.frame.index,
                 .label = work.frame.label,
                 .session = session_};
  if (params_.place.keep_thumbnails > 0) view.jpeg = thumbnail(work.pair.left, params_.place.keep_thumbnails);
  map_.addView(std::move(view));
  work.report.outcome = types::Outcome::kNewPlace;
  work.report.reason.clear();
  work.report.place = work.view;
  work.report.learnt = {work.view};
}

/// Measured: by visual odometry, or by the wheels where that has failed.
std::optional<types::RelPose> ViewMapper::motionSinceAnchor() const {
  if (!lost_) return T_anchor_robot_;
  if (params_.views.wheels && anchor_.valid() && wheels_.anchored()) return wheels_.anchorToRobot();
  return std::nullopt;
}

Eigen::Isometry3d ViewMapper::guessedPose(const Work& work) const {
  if (work.motion) return map_.place(anchor_).T_map_place * work.motion->T_a_b;
  if (!work.links.empty() && isSure(work.links.front())) {
    const Link& best = work.links.front();
    return map_.place(best.to).T_map_place * best.match.T_place_robot->T_a_b;
  }
  if (map_.path().empty()) return Eigen::Isometry3d::Identity();
  // K-E14: where it was last known to be, or the identity.
  return map_.place(lastPlace()).T_map_place * (anchor_.valid() ? T_anchor_robot_.T_a_b : kHere.T_a_b);
}

/// Where the robot was last: at wake-up, where the drive before ended (K-19). Not for an empty map (K-E12).
base::PlaceId ViewMapper::lastPlace() const { return anchor_.valid() ? anchor_ : map_.path().back().anchor; }

/// Step 5.b.ii, A and B: links, and a weak one where nothing measured joins the view to where the robot was.
void ViewMapper::relate(Work& work) {
  const StepTimer timer(work.report, "relate");
  if (work.motion) addMotion(work);
  for (const Link& link : work.links)
    if ((!work.motion || link.to != anchor_) && agrees(work, link)) addLink(work, link);
  if (!work.motion && !map_.path().empty() && !joined(lastPlace(), work.view)) {
    map::Edge weak{.type = map::EdgeType::kWeak, .a = lastPlace(), .b = work.view};
    weak.T_a_b.T_a_b = map_.place(weak.a).T_map_place.inverse() * map_.place(weak.b).T_map_place;
    weak.T_a_b.cov = types::Matrix6d::Identity() * params_.views.weak_sigma * params_.views.weak_sigma;
    map_.addEdge(std::move(weak));
  }
  linkNeighbours(work);
  if (work.joined) map::dropJoinedWeakEdges(map_, parts_);

  if (work.motion) sinceClosure_ += work.motion->T_a_b.translation().norm();
  if (work.report.closure) sinceClosure_ = 0;
  ++made_;
  anchor_ = work.view;
  anchorStamp_ = stamp_ = work.frame.stamp;
  T_anchor_keyframe_ = T_anchor_robot_ = kHere;
  wheels_.reset(Eigen::Isometry3d::Identity(), kHere.cov);
  lost_ = false;
  map_.addPathPoint({session_, work.frame.stamp, anchor_, Eigen::Isometry3d::Identity()});
}

/// The edge to the view before; it keeps the features that both views share.
void ViewMapper::addMotion(Work& work) {
  map::Edge edge;
  work.near = map_.hopDistances(anchor_, params_.place.recent_hops);
  const auto known = std::find_if(work.links.begin(), work.links.end(),
                                  [this](const Link& link) { return link.to == anchor_; });
  if (known != work.links.end()) edge = edgeOf(*known, work.view);
  edge.type = map::EdgeType::kOdometry;
  edge.a = anchor_;
  edge.b = work.view;
  edge.T_a_b = floored(*work.motion);
  addEdge(std::move(edge));
}

bool ViewMapper::isSure(const Link& link) const {
  return static_cast<int>(link.match.matches.size()) >= params_.views.sure_inliers;
}

/// K-18: things that look alike stand elsewhere too. A link must not contradict the graph where that knows
/// better than the drift of odometry; where it knows nothing, the link needs the inliers of K's experiments
/// (K-E5).
bool ViewMapper::agrees(const Work& work, const Link& link) {
  if (!joined(link.to, work.view)) return isSure(link);
  const Eigen::Isometry3d expected =
      map_.place(link.to).T_map_place.inverse() * map_.place(work.view).T_map_place;
  const Eigen::Isometry3d error = expected.inverse() * link.match.T_place_robot->T_a_b;
  const double share = work.near.contains(link.to) ? kNearShare : 1.0;
  const double limit = params_.views.agree_distance + params_.views.max_drift * sinceClosure_;
  return error.translation().norm() <= share * limit &&
         Eigen::AngleAxisd(error.linear()).angle() <= share * params_.views.agree_angle;
}

void ViewMapper::addLink(Work& work, const Link& link) {
  map::Edge edge = edgeOf(link, work.view);
  if (!work.report.closure && !work.near.contains(link.to)) {
    work.report.closure = true;
    work.report.bestGuess = link.to;
  }
  work.joined |= !joined(edge.a, edge.b);
  work.edges.push_back(addEdge(std::move(edge)));
}

/// Views that the graph has near and that the search did not find: upkeep asks which of them agree (K-24).
void ViewMapper::linkNeighbours(Work& work) {
  if (params_.upkeep.upkeep == "none") return;
  for (const auto& near : upkeep::neighbourhood(map_, work.view, budget_.near)) {
    if (std::find(work.tried.begin(), work.tried.end(), near.place) != work.tried.end()) continue;
    const auto link = linkTo(work, near.place);
    if (link && agrees(work, *link)) addLink(work, *link);
  }
}

map::Edge ViewMapper::edgeOf(const Link& link, base::PlaceId view) const {
  map::Edge edge;
  const map::Place& to = map_.place(link.to);
  edge.type = to.session == session_ ? map::EdgeType::kLoop : map::EdgeType::kRecognition;
  edge.a = link.to;
  edge.b = view;
  edge.T_a_b = *link.match.T_place_robot;
  const auto& states = map_.place(view).memory.states;
  for (const auto& m : link.match.matches)
    edge.correspondences.emplace_back(to.memory.states[static_cast<std::size_t>(m.b)].id,
                                      states[static_cast<std::size_t>(m.a)].id);
  return edge;
}

types::RelPose ViewMapper::floored(types::RelPose T) const {
  T.T_a_b = types::rigid(T.T_a_b);
  T.cov += types::Matrix6d::Identity() * params_.views.sigma_floor * params_.views.sigma_floor;
  return T;
}

bool ViewMapper::joined(base::PlaceId a, base::PlaceId b) {
  parts_.follow(map_);
  return parts_.joined(a, b);
}

/// Where it joins two parts of the map, these move to where it puts them.
base::EdgeId ViewMapper::addEdge(map::Edge edge) {
  parts_.follow(map_);
  map_.setPoses(map::aligned(map_, parts_, edge.a, edge.b, edge.T_a_b.T_a_b));
  return map_.addEdge(std::move(edge));
}

/// Step 5.b.ii, C (K-28).
void ViewMapper::forget(Work& work) {
  if (params_.upkeep.upkeep == "none") return;
  const StepTimer timer(work.report, "forget");
  const auto done = upkeep::apply(map_, upkeep::plan(map_, work.view, budget_, upkeep::edgeInliers(map_)));
  for (const auto& gone : done.removed) {
    ++work.report.memory.pruned;
    if (work.report.bestGuess == gone.place) work.report.bestGuess = gone.heir;
    if (gone.place != anchor_) continue;
    anchor_ = gone.heir;
    T_anchor_keyframe_ = T_anchor_robot_ = floored({.T_a_b = gone.T_heir_place, .cov = kHere.cov});
    wheels_.reset(T_anchor_robot_.T_a_b, T_anchor_robot_.cov);
  }
}

/// Step 5.b.ii, D: as much of the graph as the new links ask for (K-10).
void ViewMapper::relax(Work& work) {
  const StepTimer timer(work.report, "relax");
  if (!map_.places().contains(work.view) || disagreement(work.edges) <= params_.views.relax_sigma) return;
  relaxer_.around(map_, work.view);
  // The whole map seldom: over many views it costs each of them the same, however large the map.
  const bool due = made_ >= relaxedAt_ + map_.places().size() / kRelaxShare;
  if (!work.joined && (!due || disagreement(work.edges) <= params_.views.relax_all_sigma)) return;
  relaxer_.all(map_);
  relaxedAt_ = made_;
}

/// Distance of the poses from what edges measure, the median edge [standard deviations, root mean square].
double ViewMapper::disagreement(const std::vector<base::EdgeId>& edges) const {
  std::vector<double> distances;
  for (const auto id : edges) {
    if (!map_.edges().contains(id)) continue;
    const map::Edge& e = map_.edge(id);
    const auto r = posegraph::residual(e.T_a_b, map_.place(e.a).T_map_place, map_.place(e.b).T_map_place);
    distances.push_back(std::sqrt(r.dot(e.T_a_b.cov.ldlt().solve(r)) / 6.0));
  }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

void ViewMapper::finish() { relaxer_.all(map_); }

}  // namespace engram::pipeline

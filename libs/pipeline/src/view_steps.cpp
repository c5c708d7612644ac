// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "view_steps.h"

#include "engram/types/se3.h"
#include "place_steps.h"
#include "step_timer.h"
#include "view_rules.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
namespace {

/// The whole map is relaxed at most once while it grows by this share.
constexpr std::size_t kRelaxShare = 4;

/// To views that the graph has near, a link must agree better than to others: within this share.
constexpr double kNearShare = 0.4;

const types::Matrix6d kHere = types::Matrix6d::Zero();

/// Where it joins two parts of the map, these move to where it puts them.
base::EdgeId addAligned(Run& run, map::Edge edge) {
  run.parts.follow(run.map);
  run.map.setPoses(map::aligned(run.map, run.parts, edge.a, edge.b, edge.T_a_b.T_a_b));
  return run.map.addEdge(std::move(edge));
}

/// Distance of the poses from what edges measure, the median edge [standard deviations, root mean square].
double disagreement(const map::TopologicalMap& map, const std::vector<base::EdgeId>& edges) {
  std::vector<double> distances;
  for (const auto id : edges) {
    if (!map.edges().contains(id)) continue;
    const map::Edge& e = map.edge(id);
    const auto r = posegraph::residual(e.T_a_b, map.place(e.a).T_map_place, map.place(e.b).T_map_place);
    distances.push_back(std::sqrt(r.dot(e.T_a_b.cov.ldlt().solve(r)) / 6.0));
  }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace

Decision ViewDecide::decide(Run&, const Keyframe&, const Verified&, types::FrameReport& report) {
  report.outcome = types::Outcome::kNewPlace;
  report.reason.clear();
  return {.makesNode = true};
}

base::PlaceId ViewRemember::remember(Run& run, const Keyframe& image, const Verified& verified,
                                     const Decision&, types::FrameReport& report) {
  const StepTimer timer(report, "remember");
  report.place =
      addNode(run, image, types::rigid(guessedPose(run, verified.links)), memory_.start(image.features));
  report.learnt = {report.place};
  return report.place;
}

Relation ViewRelate::relate(Run& run, const Keyframe& image, const Verified& verified, const Decision&,
                            base::PlaceId node, types::FrameReport& report) {
  const StepTimer timer(report, "relate");
  Relation relation{.node = node};
  const base::PlaceId anchor = run.robot.anchor();
  const auto motion = run.robot.motion();
  Near near;
  if (motion) {
    near = run.map.hopDistances(anchor, run.params.place.recent_hops);
    addMotion(run, verified, *motion, node);
  }
  for (const Link& link : verified.links)
    if ((!motion || link.place != anchor) && agrees(run, link, node, near))
      addLink(run, link, near, relation, report);
  if (!motion) addWeak(run, node);
  linkNeighbours(run, image, verified, near, relation, report);
  if (relation.joined) map::dropJoinedWeakEdges(run.map, run.parts);

  if (motion) sinceClosure_ += motion->T_a_b.translation().norm();
  if (report.closure) sinceClosure_ = 0;
  run.robot.made(node, image.frame.stamp, kHere);
  run.robot.resume();
  run.map.addPathPoint({run.session, image.frame.stamp, node, Eigen::Isometry3d::Identity()});
  return relation;
}

/// The edge to the view before; it keeps the features that both views share.
void ViewRelate::addMotion(Run& run, const Verified& verified, const types::RelPose& motion,
                           base::PlaceId node) const {
  const base::PlaceId anchor = run.robot.anchor();
  map::Edge edge;
  for (const Link& link : verified.links)
    if (link.place == anchor) edge = edgeOf(run, link, node);
  edge.type = map::EdgeType::kOdometry;
  edge.a = anchor;
  edge.b = node;
  edge.T_a_b = floored(run, motion);
  addAligned(run, std::move(edge));
}

void ViewRelate::addWeak(Run& run, base::PlaceId node) const {
  if (run.map.path().empty() || run.joined(lastPlace(run), node)) return;
  const double sigma = run.params.views.weak_sigma;
  map::Edge weak{.type = map::EdgeType::kWeak, .a = lastPlace(run), .b = node};
  weak.T_a_b.T_a_b = run.map.place(weak.a).T_map_place.inverse() * run.map.place(weak.b).T_map_place;
  weak.T_a_b.cov = types::Matrix6d::Identity() * sigma * sigma;
  run.map.addEdge(std::move(weak));
}

/// K-18: things that look alike stand elsewhere too. A link must not contradict the graph where that knows
/// better than the drift of odometry; where it knows nothing, the link needs the inliers of K's experiments
/// (K-E5).
bool ViewRelate::agrees(Run& run, const Link& link, base::PlaceId node, const Near& near) const {
  if (!run.joined(link.place, node)) return isSure(run, link);
  const Eigen::Isometry3d expected =
      run.map.place(link.place).T_map_place.inverse() * run.map.place(node).T_map_place;
  const Eigen::Isometry3d error = expected.inverse() * link.match.T_place_robot->T_a_b;
  const double share = near.contains(link.place) ? kNearShare : 1.0;
  const double limit = run.params.views.agree_distance + run.params.views.max_drift * sinceClosure_;
  return error.translation().norm() <= share * limit &&
         Eigen::AngleAxisd(error.linear()).angle() <= share * run.params.views.agree_angle;
}

void ViewRelate::addLink(Run& run, const Link& link, const Near& near, Relation& relation,
                         types::FrameReport& report) const {
  relation.joined |= !run.joined(link.place, relation.node);
  if (!report.closure && !near.contains(link.place)) {
    report.closure = true;
    report.bestGuess = link.place;
  }
  relation.edges.push_back(addAligned(run, edgeOf(run, link, relation.node)));
}

/// Views that the graph has near and that the search did not find: upkeep asks which of them agree (K-24).
void ViewRelate::linkNeighbours(Run& run, const Keyframe& image, const Verified& verified, const Near& near,
                                Relation& relation, types::FrameReport& report) const {
  if (!budget_) return;
  const auto& tried = verified.tried;
  for (const auto& other : upkeep::neighbourhood(run.map, relation.node, budget_->near)) {
    if (std::find(tried.begin(), tried.end(), other.place) != tried.end()) continue;
    const auto link = linkTo(run, image.features, other.place);
    if (link && agrees(run, *link, relation.node, near)) addLink(run, *link, near, relation, report);
  }
}

void LruForget::forget(Run& run, const Relation& relation, types::FrameReport& report) {
  const StepTimer timer(report, "forget");
  const auto edits = upkeep::plan(run.map, relation.node, budget_, upkeep::edgeInliers(run.map));
  for (const auto& gone : upkeep::apply(run.map, edits).removed) {
    ++report.memory.pruned;
    if (report.bestGuess == gone.place) report.bestGuess = gone.heir;
    if (gone.place == run.robot.anchor())
      run.robot.inherit(gone.heir, floored(run, {.T_a_b = gone.T_heir_place, .cov = kHere}));
  }
}

void ViewRelax::relax(Run& run, const Relation& relation, types::FrameReport& report) {
  const StepTimer timer(report, "relax");
  ++made_;
  const auto& views = run.params.views;
  if (!run.map.places().contains(relation.node)) return;
  if (disagreement(run.map, relation.edges) <= views.relax_sigma) return;
  relaxer_.around(run.map, relation.node);
  // The whole map seldom: over many views it costs each of them the same, however large the map.
  const bool due = made_ >= relaxedAt_ + run.map.places().size() / kRelaxShare;
  if (!relation.joined && (!due || disagreement(run.map, relation.edges) <= views.relax_all_sigma)) return;
  relaxer_.all(run.map);
  relaxedAt_ = made_;
}

}  // namespace engram::pipeline

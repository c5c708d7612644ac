// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scan_poses.h"

#include "engram/base/error.h"
#include "engram/map/graph.h"
#include "engram/pipeline/map_relaxer.h"
#include "engram/posegraph/scan_filter.h"
#include "engram/types/se3.h"
#include "place_rules.h"

namespace engram::pipeline {
namespace {

/// Poses are written into the map while they move by more than this; all of them at the end of a drive.
constexpr double kMoved = 1e-3;  // [m] and [rad]

using posegraph::ScanFilter;

/// The joint covariance that the places keep, in the order of their ids; empty unless all do, alike.
Eigen::MatrixXd keptCovariance(const map::TopologicalMap& map, int dof) {
  std::map<base::PlaceId, Eigen::Index> at;
  for (const auto& [id, place] : map.places()) at.emplace(id, static_cast<Eigen::Index>(at.size()) * dof);
  Eigen::MatrixXd cov = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(at.size()) * dof,
                                              static_cast<Eigen::Index>(at.size()) * dof);
  Eigen::Index known = 0;
  for (const auto& [id, place] : map.places()) {
    const map::JointErrors& joint = place.joint;
    if (joint.empty() || joint.cov.rows() != dof) return {};
    for (std::size_t k = 0; k < joint.with.size(); ++k) {
      const auto other = at.find(joint.with[k]);
      if (other == at.end()) continue;  // it is gone
      const Eigen::MatrixXd block = joint.cov.middleCols(static_cast<Eigen::Index>(k) * dof, dof);
      cov.block(at.at(id), other->second, dof, dof) = block;
      cov.block(other->second, at.at(id), dof, dof) = block.transpose();
      ++known;
    }
  }
  const auto n = static_cast<Eigen::Index>(at.size());
  return known == n * (n + 1) / 2 ? cov : Eigen::MatrixXd();
}

/// As the map was kept; where it was made or moved otherwise, as its edges say.
ScanFilter filterOf(const map::TopologicalMap& map, bool planar) {
  if (map.empty()) return ScanFilter(planar);
  const posegraph::Graph graph = map::toGraph(map);
  const Eigen::MatrixXd kept = keptCovariance(map, planar ? 3 : 6);
  if (kept.size() > 0) {
    try {
      return {planar, graph.poses, kept};
    } catch (const base::Error&) {  // not positive definite
    }
  }
  return {planar, graph.poses, posegraph::jointCovariance(graph, planar)};
}

std::map<base::PlaceId, map::JointErrors> jointErrors(const ScanFilter& filter) {
  const Eigen::MatrixXd cov = filter.covariance();
  std::map<base::PlaceId, map::JointErrors> joint;
  map::JointErrors errors;
  for (const auto& [id, T] : filter.references()) {
    const auto rows = static_cast<Eigen::Index>(errors.with.size()) * filter.dof();
    errors.with.push_back(id);
    errors.cov = cov.block(rows, 0, filter.dof(), rows + filter.dof());
    joint[id] = errors;
  }
  return joint;
}

/// V-09.
class FilteredPoses final : public ScanPoses {
 public:
  explicit FilteredPoses(const Run& run) : filter_(filterOf(run.map, run.params.posegraph.planar)) {}

  void start(Run&) override { filter_.start(Eigen::Isometry3d::Identity()); }
  void lose() override { filter_.lose(); }
  bool begun(const Run&) const override { return filter_.located(); }

  void relocate(Run& run, const Link& link) override {
    filter_.relocate(link.place, *link.match.T_place_robot);
    run.robot.backAt(link.place, filter_.relative(link.place));
    run.robot.resume();
  }

  void step(Run& run, const types::RelPose& T_last_now) override {
    filter_.predict(T_last_now);
    follow(run);
  }

  types::RelPose expected(const Run&, base::PlaceId from) const override { return filter_.relative(from); }

  /// What closes a loop is an edge of the map, too: the filter needs none, but whoever localises in the map.
  bool measure(Run& run, const Link& link) override {
    std::optional<map::Edge> closure;
    if (link.place.valid() && isClosure(run, link.place))
      closure = closureBetween(run, run.robot.anchor(), *run.robot.motion(), link);
    const double probability = run.params.posegraph.gate.gate_probability;
    if (!filter_.measure(link.place, *link.match.T_place_robot, probability).accepted) return false;
    if (link.place.valid()) run.robot.backAt(link.place, filter_.relative(link.place));
    follow(run);
    if (!closure) return true;
    run.map.addEdge(std::move(*closure));
    map::dropJoinedWeakEdges(run.map, run.parts);
    return true;
  }

  Eigen::Isometry3d T_map_previous(const Run&) const override { return filter_.T_map_previous(); }

  void promote(Run& run, base::PlaceId node) override {
    filter_.promote(node);
    run.robot.backAt(node, filter_.relative(node));
    run.robot.resume();
  }

  void settle(Run& run, base::PlaceId) override {
    std::map<base::PlaceId, Eigen::Isometry3d> moved;
    for (const auto& [id, T] : filter_.references())
      if (types::logSe3(run.map.place(id).T_map_place.inverse() * T).norm() > kMoved) moved[id] = T;
    run.map.setPoses(moved);
  }

  void finish(Run& run) override {
    run.map.setPoses(filter_.references());
    run.map.setJointErrors(jointErrors(filter_));
  }

 private:
  void follow(Run& run) const {
    const base::PlaceId anchor = run.robot.anchor();
    if (anchor.valid()) run.robot.see(filter_.relative(anchor), run.robot.seenStamp(), false);
  }

  ScanFilter filter_;
};

/// The robot hangs on the reference that saw it last; the graph relaxes the references, and judges closures.
class GraphPoses final : public ScanPoses {
 public:
  explicit GraphPoses(const Run& run) : relaxer_(run.params.posegraph) {}

  void start(Run&) override { T_start_robot_ = {.cov = types::Matrix6d::Zero()}; }
  void lose() override { T_start_robot_.reset(); }
  bool begun(const Run& run) const override { return T_start_robot_ || run.robot.metric(); }

  void relocate(Run& run, const Link& link) override {
    T_start_robot_.reset();
    run.robot.backAt(link.place, *link.match.T_place_robot);
    run.robot.resume();
  }

  void step(Run& run, const types::RelPose& T_last_now) override {
    previousAnchor_ = run.robot.anchor();
    T_anchor_previous_ = previousAnchor_.valid() ? *run.robot.motion() : *T_start_robot_;
    T_previous_robot_ = T_last_now;
    follow(run);
  }

  types::RelPose expected(const Run& run, base::PlaceId from) const override {
    return from.valid() ? expectedAt(run, from) : T_previous_robot_;
  }

  bool measure(Run& run, const Link& link) override {
    if (link.place.valid() && isClosure(run, link.place)) return close(run, link);
    types::RelPose T = expected(run, link.place);
    if (!correct(run, T, *link.match.T_place_robot)) return false;
    if (link.place.valid()) {
      run.robot.backAt(link.place, T);
    } else {
      T_previous_robot_ = T;
      follow(run);
    }
    return true;
  }

  Eigen::Isometry3d T_map_previous(const Run& run) const override {
    return previousAnchor_.valid() ? run.map.place(previousAnchor_).T_map_place * T_anchor_previous_.T_a_b
                                   : T_anchor_previous_.T_a_b;
  }

  void promote(Run& run, base::PlaceId node) override {
    T_start_robot_.reset();
    run.robot.backAt(node, T_previous_robot_);
    run.robot.resume();
  }

  void settle(Run& run, base::PlaceId made) override {
    if (made.valid() && run.map.neighbours(made).size() > 1) relaxer_.around(run.map, made);
  }

  void finish(Run& run) override {
    if (run.closures.empty()) return relaxer_.all(run.map);
    run.closures.review(run.map);
    run.closures.apply(run.map);
  }

 private:
  /// Kalman's update of one relative pose, the references as they are; none of what the gate refuses.
  static bool correct(const Run& run, types::RelPose& T, const types::RelPose& measured) {
    static const std::vector<int> kPlane{0, 1, 5}, kSpace{0, 1, 2, 3, 4, 5};
    const bool planar = run.params.posegraph.planar;
    const auto& free = planar ? kPlane : kSpace;
    const types::Vector6d gap = types::logSe3(T.T_a_b.inverse() * measured.T_a_b);
    const types::Matrix6d S = T.cov + measured.cov;
    const Eigen::VectorXd part = gap(free);
    const double chi2 = part.dot(Eigen::MatrixXd(S(free, free)).ldlt().solve(part));
    if (chi2 > posegraph::chi2Bound(run.params.posegraph.gate.gate_probability, planar ? 3 : 6)) return false;
    const types::Matrix6d K = S.ldlt().solve(T.cov).transpose();
    T.T_a_b = types::rigid(T.T_a_b * types::expSe3(K * gap));
    T.cov = types::symmetric((types::Matrix6d::Identity() - K) * T.cov);
    return true;
  }

  /// The graph judges what joins places that it has no short way between; one of each pair suffices.
  static bool close(Run& run, const Link& link) {
    const base::PlaceId here = run.robot.anchor();
    if (run.closures.count(here, link.place) == 0) {
      const map::Edge edge = closureBetween(run, here, *run.robot.motion(), link);
      const bool accepted = run.closures.propose(run.map, edge).accepted;
      run.closures.apply(run.map);
      map::dropJoinedWeakEdges(run.map, run.parts);
      if (!accepted) return false;
    } else if (isClosure(run, link.place)) {
      return false;  // the graph has refused such a one
    }
    run.robot.backAt(link.place, *link.match.T_place_robot);
    return true;
  }

  void follow(Run& run) {
    const auto T = types::compose(T_anchor_previous_, T_previous_robot_);
    if (previousAnchor_.valid())
      run.robot.see(T, run.robot.seenStamp(), false);
    else
      T_start_robot_ = T;
  }

  MapRelaxer relaxer_;
  std::optional<types::RelPose> T_start_robot_;  // before there is a reference
  base::PlaceId previousAnchor_;
  types::RelPose T_anchor_previous_, T_previous_robot_;
};

}  // namespace

std::unique_ptr<ScanPoses> makeScanPoses(const Run& run) {
  if (run.params.posegraph.relaxer == "ekf_scans") return std::make_unique<FilteredPoses>(run);
  return std::make_unique<GraphPoses>(run);
}

}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_rules.h"

#include "engram/types/se3.h"

#include <algorithm>

namespace engram::pipeline {
namespace {

Eigen::Isometry3d withRotation(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = t;
  return T;
}

/// As measured by both eyes, with the least covariance that an edge may have.
std::optional<types::RelPose> measured(const Run& run, const PlaceMatch& match) {
  if (!match.verified() || !match.T_place_robot) return std::nullopt;
  const double sigma = run.params.odometry.sigma_floor;
  types::RelPose T = *match.T_place_robot;
  T.T_a_b = types::rigid(T.T_a_b);
  T.cov += types::Matrix6d::Identity() * sigma * sigma;
  return T;
}

bool isRecent(const Run& run, base::PlaceId place) {
  return run.robot.frontier() && run.robot.recent().contains(place);
}

}  // namespace

double spacingHere(const Run& run) {
  return run.params.place.spacing * (run.robot.frontier() ? 1.0 : kLeaveFactor);
}

bool isClosure(const Run& run, base::PlaceId place) {
  const base::PlaceId anchor = run.robot.anchor();
  return anchor.valid() && !run.map.hopDistances(anchor, run.params.place.recent_hops).contains(place);
}

Eigen::Isometry3d T_place_robot(const Run& run, base::PlaceId place) {
  return run.map.place(place).T_map_place.inverse() * run.map.place(run.robot.anchor()).T_map_place *
         run.robot.motion()->T_a_b;
}

std::optional<std::pair<base::PlaceId, double>> nearestByOdometry(const Run& run) {
  if (!run.robot.metric()) return std::nullopt;
  std::optional<std::pair<base::PlaceId, double>> best;
  for (const auto& [id, hops] : run.map.hopDistances(run.robot.anchor(), run.params.place.recent_hops)) {
    const double distance = T_place_robot(run, id).translation().norm();
    if (!best || distance < best->second) best = {id, distance};
  }
  return best;
}

bool agreesWithMotion(const Run& run, base::PlaceId place) {
  const base::PlaceId anchor = run.robot.anchor();
  if (!anchor.valid()) return true;
  if (!run.robot.metric()) {  // it goes on by a place an image at most, as far as anybody knows
    const int reach = run.params.place.recent_hops + run.robot.imagesSinceAnchor();
    return run.map.hopDistances(anchor, reach).contains(place);
  }
  const Eigen::Isometry3d T_map_robot = run.map.place(anchor).T_map_place * run.robot.motion()->T_a_b;
  const double distance = (run.map.place(place).T_map_place.translation() - T_map_robot.translation()).norm();
  return distance <= 2.0 * run.params.place.spacing + run.params.odometry.max_drift * run.robot.sinceAnchor();
}

std::function<bool(base::PlaceId)> farFrom(const Run& run, base::PlaceId place) {
  const auto near = run.map.hopDistances(place, run.params.place.recent_hops);
  const Eigen::Vector3d here = run.map.place(place).T_map_place.translation();
  const double beside = 2.0 * run.params.place.spacing;
  return [&run, near, here, beside](base::PlaceId other) {
    return !near.contains(other) && (run.map.place(other).T_map_place.translation() - here).norm() > beside;
  };
}

bool fitsWay(const Run& run, const Link& link) {
  return agreesWithMotion(run, link.place) ||
         static_cast<int>(link.match.matches.size()) >= run.params.recognise.closure_inliers;
}

bool fitsTerrain(const Run& run, const Link& link) {
  if (!run.robot.anchor().valid()) return true;
  const bool closes = isClosure(run, link.place);
  if (closes && static_cast<int>(link.match.matches.size()) < run.params.recognise.closure_inliers)
    return false;
  if (!run.robot.metric())
    return !isRecent(run, link.place) || link.match.similarity >= run.params.place.same_similarity;
  return closes || T_place_robot(run, link.place).translation().norm() < spacingHere(run);
}

types::RelPose motionFrom(const Run& run, base::PlaceId from, std::span<const Link> links) {
  for (const auto& [id, match] : links)
    if (const auto seen = measured(run, match); id == from && seen) return *seen;
  const base::PlaceId anchor = run.robot.anchor();
  if (from == anchor)
    if (const auto motion = run.robot.motion()) return *motion;
  const double spacing = run.params.place.spacing;
  types::RelPose guess;
  guess.T_a_b.translation().x() = anchor.valid() ? spacing : 0.0;
  guess.cov = planarCovariance(spacing, spacing, 1.0, run.params.odometry.sigma_floor);
  for (const auto& [id, match] : links)
    if (id == from && match.verified())
      guess.T_a_b = withRotation(match.R_place_view, spacing * match.direction_place);
  return guess;
}

types::RelPose atPlace(const Run& run, const Link& link) {
  if (const auto seen = measured(run, link.match)) return *seen;
  const double extent = 0.5 * run.params.place.spacing;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  if (run.robot.metric() && !isClosure(run, link.place)) {
    offset = T_place_robot(run, link.place).translation();
    offset *= std::min(1.0, extent / std::max(1e-9, offset.norm()));
  }
  return {.T_a_b = withRotation(link.match.R_place_view, offset),
          .cov = planarCovariance(extent, extent, 0.05, run.params.odometry.sigma_floor)};
}

map::Edge closureTo(const Run& run, const Link& link, std::span<const Link> links) {
  map::Edge edge;
  edge.type = closureType(run, link.place);
  edge.a = run.robot.anchor();
  edge.b = link.place;
  edge.T_a_b = types::compose(motionFrom(run, edge.a, links), types::inverse(atPlace(run, link)));
  return edge;
}

map::EdgeType closureType(const Run& run, base::PlaceId to) {
  return run.map.place(to).session == run.session ? map::EdgeType::kLoop : map::EdgeType::kRecognition;
}

}  // namespace engram::pipeline

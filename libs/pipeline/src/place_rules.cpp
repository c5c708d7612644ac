// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_rules.h"

#include "engram/pipeline/place_fix.h"
#include "engram/types/se3.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {
namespace {

constexpr std::size_t kOverrules = 40;  // matches of one image that overrule odometry

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

/// Relative pose of two places, with what the map does not know of it.
types::RelPose between(const Run& run, base::PlaceId a, base::PlaceId b) {
  const Eigen::Isometry3d T_a_b = run.map.place(a).T_map_place.inverse() * run.map.place(b).T_map_place;
  const auto& odometry = run.params.odometry;
  const double root = std::sqrt(T_a_b.translation().norm());
  const double sigma = odometry.sigma_per_metre * root;
  return {
      .T_a_b = T_a_b,
      .cov = planarCovariance(sigma, sigma, odometry.sigma_heading_per_metre * root, odometry.sigma_floor)};
}

/// The way since the anchor by odometry, corrected by what one eye saw of it; by the eye alone where it knows
/// the length and is sure that odometry is wrong.
types::RelPose seenOf(const Run& run, const types::RelPose& motion, std::span<const Link> links) {
  const Eigen::Vector3d eye = run.perception.eye();
  for (const Link& link : links) {
    if (link.place != run.robot.anchor()) continue;
    if (callsOdometryWrong(run, link)) return *measuredBy(link.match, eye);
    if (withOdometry(run, link) == Agreement::kAgrees) return correctedBy(link.match, motion, eye);
  }
  return motion;
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

Eigen::Isometry3d T_map_robot(const Run& run) {
  return run.map.place(run.robot.anchor()).T_map_place * run.robot.motion()->T_a_b;
}

Eigen::Isometry3d T_place_robot(const Run& run, base::PlaceId place) {
  return run.map.place(place).T_map_place.inverse() * T_map_robot(run);
}

types::RelPose expectedAt(const Run& run, base::PlaceId place) {
  return types::compose(between(run, place, run.robot.anchor()), *run.robot.motion());
}

bool onePose(const Run& run, const Link& a, const Link& b) {
  const Eigen::Vector3d eye = run.perception.eye();
  const auto measured = measuredBy(a.match, eye);
  if (!measured || !measuredBy(b.match, eye)) return false;
  return agrees(b.match, types::compose(between(run, b.place, a.place), *measured), eye);
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
  const Eigen::Vector3d here = T_map_robot(run).translation();
  const double distance = (run.map.place(place).T_map_place.translation() - here).norm();
  return distance <= 2.0 * run.params.place.spacing + run.params.odometry.max_drift * run.robot.sinceAnchor();
}

Agreement withOdometry(const Run& run, const Link& link) {
  const bool expects = run.robot.metric() && run.robot.sinceKeyframe().known() && !isClosure(run, link.place);
  if (!expects || link.match.T_place_robot || !link.match.verified()) return Agreement::kUnknown;
  const bool fits = agrees(link.match, expectedAt(run, link.place), run.perception.eye());
  return fits ? Agreement::kAgrees : Agreement::kContradicts;
}

bool callsOdometryWrong(const Run& run, const Link& link) {
  return run.params.recognise.sure_inliers > 0 && link.match.length &&
         link.match.matches.size() >= kOverrules && withOdometry(run, link) == Agreement::kContradicts;
}

std::function<bool(base::PlaceId)> farFrom(const Run& run, base::PlaceId place) {
  const auto near = run.map.hopDistances(place, run.params.place.recent_hops);
  const Eigen::Vector3d here = run.map.place(place).T_map_place.translation();
  const double beside = 2.0 * run.params.place.spacing;
  const bool metric = !run.map.place(place).memory.features.ranges.empty();
  return [&run, near, here, beside, metric](base::PlaceId other) {
    if (!metric) return !near.contains(other);  // poses that nothing measured are no distances
    return !near.contains(other) && (run.map.place(other).T_map_place.translation() - here).norm() > beside;
  };
}

bool fitsWay(const Run& run, const Link& link) {
  return agreesWithMotion(run, link.place) ||
         static_cast<int>(link.match.matches.size()) >= run.params.recognise.closure_inliers;
}

int closureInliers(Run& run, const Link& link) {
  const bool judged = link.match.length && run.robot.metric() && run.joined(run.robot.anchor(), link.place);
  return judged ? run.params.recognise.accept_inliers : run.params.recognise.closure_inliers;
}

bool fitsTerrain(Run& run, const Link& link) {
  if (!run.robot.anchor().valid()) return true;
  const bool closes = isClosure(run, link.place);
  if (closes && static_cast<int>(link.match.matches.size()) < closureInliers(run, link)) return false;
  if (!run.robot.metric())
    return !isRecent(run, link.place) || link.match.similarity >= run.params.place.same_similarity;
  if (closes || callsOdometryWrong(run, link)) return true;
  const double distance = run.robot.frontier() ? T_place_robot(run, link.place).translation().norm()
                                               : nearestByOdometry(run)->second;
  return distance < spacingHere(run);
}

bool seesWay(base::PlaceId from, std::span<const Link> links) {
  return std::any_of(links.begin(), links.end(),
                     [from](const Link& link) { return link.place == from && link.match.verified(); });
}

types::RelPose motionFrom(const Run& run, base::PlaceId from, std::span<const Link> links) {
  for (const Link& link : links)
    if (const auto seen = measured(run, link.match); link.place == from && seen) return *seen;
  const base::PlaceId anchor = run.robot.anchor();
  if (from == anchor)
    if (const auto motion = run.robot.motion()) return seenOf(run, *motion, links);
  const double spacing = run.params.place.spacing;
  types::RelPose guess;
  guess.T_a_b.translation().x() = anchor.valid() ? spacing : 0.0;
  guess.cov = planarCovariance(spacing, spacing, 1.0, run.params.odometry.sigma_floor);
  for (const Link& link : links) {
    if (link.place != from || !link.match.verified()) continue;
    if (link.match.length) return *measuredBy(link.match, run.perception.eye());
    guess.T_a_b = withRotation(link.match.R_place_view, spacing * link.match.direction_place);
  }
  return guess;
}

types::RelPose atPlace(const Run& run, const Link& link) {
  if (const auto seen = measured(run, link.match)) return *seen;
  const double extent = 0.5 * run.params.place.spacing;
  const types::RelPose near{.T_a_b = withRotation(link.match.R_place_view, Eigen::Vector3d::Zero()),
                            .cov = planarCovariance(extent, extent, 0.05, run.params.odometry.sigma_floor)};
  if (!run.robot.sinceKeyframe().known()) return near;
  const Eigen::Vector3d eye = run.perception.eye();
  if (run.robot.metric() && !isClosure(run, link.place) && !link.overrules)
    return correctedBy(link.match, expectedAt(run, link.place), eye);
  return measuredBy(link.match, eye).value_or(correctedBy(link.match, near, eye));
}

map::Edge closureTo(const Run& run, const Link& link, std::span<const Link> links) {
  map::Edge edge;
  edge.type = closureType(run, link.place);
  edge.a = run.robot.anchor();
  edge.b = link.place;
  edge.T_a_b = types::compose(motionFrom(run, edge.a, links), types::inverse(atPlace(run, link)));
  return edge;
}

map::Edge closureBetween(const Run& run, base::PlaceId place, const types::RelPose& T_place_robot,
                         const Link& link) {
  const bool oneDrive = run.map.place(place).session == run.map.place(link.place).session;
  return {.type = oneDrive ? map::EdgeType::kLoop : map::EdgeType::kRecognition,
          .a = place,
          .b = link.place,
          .T_a_b = types::compose(T_place_robot, types::inverse(atPlace(run, link)))};
}

map::EdgeType closureType(const Run& run, base::PlaceId to) {
  return run.map.place(to).session == run.session ? map::EdgeType::kLoop : map::EdgeType::kRecognition;
}

}  // namespace engram::pipeline

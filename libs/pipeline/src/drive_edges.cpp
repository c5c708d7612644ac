// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "drive_edges.h"

#include "engram/pipeline/place_fix.h"
#include "engram/types/se3.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace engram::pipeline {
namespace {

// Drives hold to the map by edges over this many spacings, between poses known so well [m], when they differ
// from the map by less than that [m], [rad], and not by more than so many at a place: months of drives must
// not make the graph grow.
constexpr double kHoldSpacings = 5, kHoldSigma = 0.15, kHoldGap = 0.5, kHoldTurn = 0.15;
constexpr std::ptrdiff_t kMostHolds = 12;

bool isSharp(const types::RelPose& measured) {
  return measured.cov(0, 0) <= kHoldSigma * kHoldSigma && measured.cov(1, 1) <= kHoldSigma * kHoldSigma;
}

bool fitsMap(const Run& run, const map::Edge& edge) {
  const Eigen::Isometry3d now =
      run.map.place(edge.a).T_map_place.inverse() * run.map.place(edge.b).T_map_place;
  const types::Vector6d gap = types::logSe3(edge.T_a_b.T_a_b.inverse() * now);
  return gap.head<3>().norm() < kHoldGap && gap.tail<3>().norm() < kHoldTurn;
}

std::ptrdiff_t holdsAt(const Run& run, base::PlaceId place) {
  const auto around = run.map.neighbours(place);
  return std::count_if(around.begin(), around.end(),
                       [](const map::Neighbour& n) { return n.type == map::EdgeType::kDeadReckoning; });
}

}  // namespace

void watchOdometry(Run& run, std::span<const Link> links) {
  const auto motion = run.robot.motion();
  if (!motion) return;
  for (const Link& link : links)
    if (link.place == run.robot.anchor() && strongEnough(link.match, run.params.recognise) &&
        !link.match.T_place_robot)
      run.robot.watch().compare(motion->T_a_b, link.match.R_place_view, link.match.direction_place);
}

void holdToMap(Run& run, const Link& link) {
  const auto measured = measuredBy(link.match, run.perception.eye());
  if (!measured || link.overrules || !isSharp(*measured)) return;
  if (const auto& T_odom_robot = run.robot.odometry()) {
    const Eigen::Isometry3d T_map_robot = run.map.place(link.place).T_map_place * measured->T_a_b;
    run.scale.add(T_map_robot.translation(), T_odom_robot->translation(), run.robot.piece());
  }
  const base::PlaceId from = run.robot.marked();
  if (from.valid() && run.robot.sinceMark().anchored()) {
    const types::RelPose& way = run.robot.sinceMark().anchorToRobot();
    if (way.T_a_b.translation().norm() < kHoldSpacings * run.params.place.spacing) return;
    const map::Edge edge{.type = map::EdgeType::kDeadReckoning,
                         .a = from,
                         .b = link.place,
                         .T_a_b = types::compose(way, types::inverse(*measured))};
    if (fitsMap(run, edge) && holdsAt(run, from) < kMostHolds) run.map.addEdge(edge);
  }
  run.robot.mark(link.place, *measured);
}

void agreeOnTheMetre(Run& run, std::uint32_t firstEdge) {
  const auto ratio = run.scale.ratio();
  const double sigma = run.params.odometry.sigma_scale;
  if (!ratio || run.session == 0 || !(sigma > 0)) return;
  const Stretch stretch = stretchFor(*ratio, run.session, sigma);
  std::vector<std::pair<base::EdgeId, double>> factors;
  for (const auto& [id, edge] : run.map.edges())
    if (edge.type == map::EdgeType::kOdometry || edge.type == map::EdgeType::kDeadReckoning)
      factors.emplace_back(id, id.value < firstEdge ? stretch.earlier : stretch.own);
  for (const auto& [id, factor] : factors) run.map.stretchEdge(id, factor);
}

}  // namespace engram::pipeline

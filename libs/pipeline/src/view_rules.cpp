// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "view_rules.h"

#include "engram/types/se3.h"
#include "place_rules.h"

namespace engram::pipeline {

std::optional<Link> linkTo(const Run& run, const types::Features& image, base::PlaceId view) {
  Link link{view, heldAgainst(image, run.map.place(view).memory, run.params, run.perception.stereo())};
  if (!link.match.verified()) return std::nullopt;
  link.match.T_place_robot = floored(run, *link.match.T_place_robot);
  return link;
}

types::RelPose floored(const Run& run, types::RelPose T) {
  const double sigma = run.params.views.sigma_floor;
  T.T_a_b = types::rigid(T.T_a_b);
  T.cov += types::Matrix6d::Identity() * sigma * sigma;
  return T;
}

bool isSure(const Run& run, const Link& link) {
  return static_cast<int>(link.match.matches.size()) >= run.params.views.sure_inliers;
}

base::PlaceId lastPlace(const Run& run) {
  const base::PlaceId anchor = run.robot.anchor();
  return anchor.valid() ? anchor : run.map.path().back().anchor;
}

Eigen::Isometry3d guessedPose(const Run& run, const std::vector<Link>& links) {
  const base::PlaceId anchor = run.robot.anchor();
  if (const auto motion = run.robot.motion()) return run.map.place(anchor).T_map_place * motion->T_a_b;
  if (!links.empty() && isSure(run, links.front())) {
    const Link& best = links.front();
    return run.map.place(best.place).T_map_place * best.match.T_place_robot->T_a_b;
  }
  if (run.map.path().empty()) return Eigen::Isometry3d::Identity();
  // K-E14: where it was last known to be, or the identity.
  const Eigen::Isometry3d& T_map_last = run.map.place(lastPlace(run)).T_map_place;
  return anchor.valid() ? T_map_last * run.robot.lastSeen().T_a_b : T_map_last;
}

map::Edge edgeOf(const Run& run, const Link& link, base::PlaceId view) {
  map::Edge edge{.type = closureType(run, link.place), .a = link.place, .b = view};
  edge.T_a_b = *link.match.T_place_robot;
  const auto& statesA = run.map.place(link.place).memory->states;
  const auto& statesB = run.map.place(view).memory->states;
  for (const auto& m : link.match.matches)
    edge.correspondences.emplace_back(statesA[static_cast<std::size_t>(m.b)].id,
                                      statesB[static_cast<std::size_t>(m.a)].id);
  return edge;
}

}  // namespace engram::pipeline

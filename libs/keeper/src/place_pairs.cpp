// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_pairs.h"

#include "engram/pipeline/closure_book.h"
#include "engram/pipeline/dead_reckoning.h"
#include "engram/pipeline/map_relaxer.h"
#include "engram/pipeline/place_fix.h"
#include "engram/types/se3.h"

namespace engram::keeper {
namespace {

constexpr double kNearHeading = 0.05;  // [rad] of a place that is recognised, as far as its extent goes

}  // namespace

PlacePairs::PlacePairs(const Configuration& configuration)
    : configuration_(configuration),
      perception_(configuration.params.camera, configuration.params.extractor) {}

pipeline::PlaceMatch PlacePairs::match(const memory::PlaceMemory& view,
                                       const memory::PlaceMemory& place) const {
  return pipeline::heldAgainst(view.features, place, configuration_.params, perception_.stereo());
}

types::RelPose PlacePairs::T_place_view(const pipeline::PlaceMatch& match) const {
  const pipeline::OdometryParams& odometry = configuration_.params.odometry;
  if (match.T_place_robot) {
    types::RelPose T = *match.T_place_robot;
    T.T_a_b = types::rigid(T.T_a_b);
    T.cov += types::Matrix6d::Identity() * odometry.sigma_floor * odometry.sigma_floor;
    return T;
  }
  const double extent = 0.5 * configuration_.params.place.spacing;
  types::RelPose near;
  near.T_a_b.linear() = match.R_place_view;
  near.cov = pipeline::planarCovariance(extent, extent, kNearHeading, odometry.sigma_floor);
  const Eigen::Vector3d eye = perception_.eye();
  return pipeline::measuredBy(match, eye).value_or(pipeline::correctedBy(match, near, eye));
}

std::vector<map::EdgeId> relaxAll(map::MapContent& content, const pipeline::PipelineParams& params) {
  map::TopologicalMap map(std::move(content));
  pipeline::ClosureBook book(params.posegraph);
  const bool views = params.mapping.nodes == "views";
  if (!views) book.load(map);
  std::vector<map::EdgeId> dropped;
  if (book.empty()) {
    pipeline::MapRelaxer(params.posegraph).all(map);
  } else {
    book.review(map);
    dropped = book.apply(map).dropped;
  }
  content = map.content();
  return dropped;
}

}  // namespace engram::keeper

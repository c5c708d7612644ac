// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/place_match.h"

#include "engram/types/se3.h"

#include <algorithm>
#include <cmath>

namespace engram::pipeline {

double similarity(int matches, int referenceFeatures) {
  if (matches <= 0 || referenceFeatures <= 0) return 0.0;
  return std::sqrt(std::min(1.0, static_cast<double>(matches) / referenceFeatures));
}

bool strongEnough(const PlaceMatch& match, const RecogniseParams& params) {
  if (!match.verified()) return false;
  if (match.log10Nfa <= params.accept_log10_nfa) return true;
  return static_cast<int>(match.matches.size()) >= params.accept_inliers &&
         match.similarity >= params.accept_similarity;
}

std::span<types::Hypothesis> candidatesOf(std::vector<types::Hypothesis>& hypotheses,
                                          const RecogniseParams& params) {
  return std::span(hypotheses)
      .first(std::min(hypotheses.size(), static_cast<std::size_t>(params.candidates)));
}

void noteInliers(std::vector<types::Hypothesis>& hypotheses, const types::Hypothesis& verified) {
  const auto known = std::find_if(hypotheses.begin(), hypotheses.end(),
                                  [&](const auto& h) { return h.place == verified.place; });
  if (known == hypotheses.end())
    hypotheses.push_back(verified);
  else
    known->inliers = verified.inliers;
}

types::Features inPlaceFrame(types::Features view, const Eigen::Matrix3d& R_place_view) {
  const Eigen::Matrix3f R = R_place_view.cast<float>();
  for (auto& bearing : view.bearings) bearing = (R * bearing).normalized();
  return view;
}

namespace {

/// Takes over the matches that geometry confirms.
void keepInliers(PlaceMatch& result, const memory::PlaceMemory& place,
                 const std::vector<types::Match>& tentative, const std::vector<int>& inliers) {
  result.tentative = static_cast<int>(tentative.size());
  for (const int i : inliers) {
    const types::Match& m = tentative[static_cast<std::size_t>(i)];
    result.matches.push_back(m);
    const auto stage = place.states[static_cast<std::size_t>(m.b)].stage;
    result.longTermInliers += stage == memory::Stage::kLongTerm;
  }
  result.similarity = similarity(result.longTermInliers, static_cast<int>(place.longTerm().size()));
}

}  // namespace

PlaceMatch matchToPlace(const types::Features& view, const memory::PlaceMemory& place,
                        const features::MatchParams& match, const geometry::VerifyParams& verify) {
  const std::vector<types::Match> tentative = features::match(view, place.features, match);
  const geometry::Verification v =
      geometry::verify(view, place.features, tentative, Eigen::Vector3d::UnitZ(), verify);

  PlaceMatch result;
  result.reason = v.reason;
  result.log10Nfa = v.log10Nfa;
  const Eigen::Isometry3d T_place_view = v.T_a_b.T_a_b.inverse();
  result.R_place_view = T_place_view.linear();
  result.direction_place = T_place_view.translation();
  keepInliers(result, place, tentative, v.inliers);
  return result;
}

PlaceMatch matchToPlace(const types::Features& view, const memory::PlaceMemory& place,
                        const features::MatchParams& match, const geometry::StereoVerifyParams& verify,
                        const StereoCamera& camera) {
  const std::vector<types::Match> tentative = features::match(view, place.features, match);
  const geometry::StereoVerification v =
      geometry::verifyStereo(view, place.features, tentative, camera.model, verify);

  PlaceMatch result;
  result.reason = v.reason;
  keepInliers(result, place, tentative, v.inliers);
  if (!v.ok()) return result;
  const types::RelPose T_place_robot = camera.ofRobot(types::inverse(v.T_a_b));
  result.T_place_robot = T_place_robot;
  result.R_place_view = T_place_robot.T_a_b.linear();
  result.direction_place = T_place_robot.T_a_b.translation().normalized();
  return result;
}

PlaceMatch heldAgainst(const types::Features& view, const memory::PlaceMemory& place,
                       const PipelineParams& params, const std::optional<StereoCamera>& stereo) {
  return stereo ? matchToPlace(view, place, params.match, params.stereo, *stereo)
                : matchToPlace(view, place, params.match, params.verify);
}

}  // namespace engram::pipeline

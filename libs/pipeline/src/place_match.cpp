// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/place_match.h"

#include "engram/types/se3.h"

#include <Eigen/Eigenvalues>

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

namespace {

/// A place has learnt its features from more than one point, so that errors are so many times those that the
/// noise of the rays tells, and never smaller than the floors. Measured on simulated drives.
constexpr double kFormalFactor = 8;
constexpr double kRotationFloor = 0.005;  // [rad]
constexpr double kDirectionFloor = 0.03;  // [rad]

/// Standard deviation along the least known axis.
double largestSigma(const Eigen::Matrix3d& cov) {
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(cov).eigenvalues()[2]));
}

/// Root mean square distance from the middle of these keypoints [px].
double spreadOf(const std::vector<types::Keypoint>& keypoints) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0;
  for (const types::Keypoint& k : keypoints) {
    sum += Eigen::Vector2d(k.x, k.y);
    squares += Eigen::Vector2d(k.x, k.y).squaredNorm();
  }
  const double n = std::max<double>(1, static_cast<double>(keypoints.size()));
  return std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm()));
}

bool seesAllRound(const types::Features& view) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& bearing : view.bearings) sum += bearing;
  return !view.bearings.empty() && sum.head<2>().norm() < 0.5f * static_cast<float>(view.size());
}

double spreadOf(const types::Features& view, const std::vector<types::Match>& matches) {
  if (!seesAllRound(view)) return 1;
  std::vector<types::Keypoint> matched;
  for (const types::Match& m : matches) matched.push_back(view.keypoints[static_cast<std::size_t>(m.a)]);
  return spreadOf(matched) / std::max(1e-9, spreadOf(view.keypoints));
}

/// Takes over the matches that geometry confirms.
void keepInliers(PlaceMatch& result, const types::Features& view, const memory::PlaceMemory& place,
                 const std::vector<types::Match>& tentative, const std::vector<int>& inliers) {
  result.tentative = static_cast<int>(tentative.size());
  for (const int i : inliers) {
    const types::Match& m = tentative[static_cast<std::size_t>(i)];
    result.matches.push_back(m);
    const auto stage = place.states[static_cast<std::size_t>(m.b)].stage;
    result.longTermInliers += stage == memory::Stage::kLongTerm;
  }
  result.spread = spreadOf(view, result.matches);
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
  keepInliers(result, view, place, tentative, v.inliers);
  if (!result.verified()) return result;
  const types::Matrix6d cov = types::inverse(v.T_a_b).cov;
  result.sigmaRotation =
      std::hypot(kRotationFloor, kFormalFactor * largestSigma(cov.bottomRightCorner<3, 3>()));
  result.sigmaDirection =
      std::hypot(kDirectionFloor, kFormalFactor * largestSigma(cov.topLeftCorner<3, 3>()));
  result.length = lengthOf(view, place.features, result.matches, result.R_place_view, result.direction_place);
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
  keepInliers(result, view, place, tentative, v.inliers);
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

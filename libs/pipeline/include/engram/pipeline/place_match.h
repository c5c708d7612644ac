// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/features/matching.h"
#include "engram/geometry/stereo_verify.h"
#include "engram/geometry/verify.h"
#include "engram/memory/place_memory.h"
#include "engram/pipeline/landmarks.h"
#include "engram/pipeline/params.h"
#include "engram/types/frame_report.h"
#include "engram/types/match.h"

#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

namespace engram::pipeline {

/// One view held against one place: what agrees in appearance and geometry.
struct PlaceMatch {
  geometry::Reason reason = geometry::Reason::kTooFewMatches;
  int tentative = 0;                  ///< matches by descriptor alone
  std::vector<types::Match> matches;  ///< verified; a = feature of the view, b = feature of the memory
  int longTermInliers = 0;            ///< of them, those with long-term features
  double similarity = 0.0;            ///< F eq (8) over verified long-term matches
  double log10Nfa = 0.0;              ///< of an accident with as many inliers; by two-view geometry alone
  Eigen::Matrix3d R_place_view = Eigen::Matrix3d::Identity();
  Eigen::Vector3d direction_place = Eigen::Vector3d::Zero();  ///< unit vector to the view; zero: no parallax
  double sigmaRotation = 0;                                   ///< standard deviation of R_place_view [rad],
  double sigmaDirection = 0;     ///< and of direction_place [rad]; by two-view geometry alone
  std::optional<Length> length;  ///< of the way to the view, where the place knows how far its features are
  std::optional<types::RelPose> T_place_robot;  ///< with scale; by stereo alone
  /// How far the verified matches are apart in a view that sees all round, as a share of all its features:
  /// matches of one thing that has been carried elsewhere lie together. 1 for other views, which one thing
  /// may fill.
  double spread = 1;
  bool verified() const { return reason == geometry::Reason::kOk; }
};

/// match() of F-06: nearest neighbours, then epipolar geometry. Short-term features take part, so that they
/// can be rehearsed (F-E3); the similarity counts long-term ones alone (F-02).
PlaceMatch matchToPlace(const types::Features& view, const memory::PlaceMemory& place,
                        const features::MatchParams& match, const geometry::VerifyParams& verify);

/// The same by the 3D points that a stereo camera saw (K-08); rejects below StereoVerifyParams::min_inliers
/// (K-09).
PlaceMatch matchToPlace(const types::Features& view, const memory::PlaceMemory& place,
                        const features::MatchParams& match, const geometry::StereoVerifyParams& verify,
                        const StereoCamera& camera);

/// By the one or the other, as there is a stereo camera or not.
PlaceMatch heldAgainst(const types::Features& view, const memory::PlaceMemory& place,
                       const PipelineParams& params, const std::optional<StereoCamera>& stereo);

/// Whether a match suffices to say that the robot is there.
bool strongEnough(const PlaceMatch& match, const RecogniseParams& params);

/// The hypotheses that may be verified: the first `candidates`.
std::span<types::Hypothesis> candidatesOf(std::vector<types::Hypothesis>& hypotheses,
                                          const RecogniseParams& params);

/// Notes how many matches of a hypothesis were verified; one that is not among them is added.
void noteInliers(std::vector<types::Hypothesis>& hypotheses, const types::Hypothesis& verified);

/// F eq (8) as F-E11 simplifies it: sqrt(matches / features of the reference); 0 for an empty reference.
double similarity(int matches, int referenceFeatures);

/// From this similarity of verified matches on, a view that shows no parallax was taken at the same spot.
/// Below, what lies ahead of a camera that moves forward may hide it.
inline constexpr double kSameSpot = 0.7;

}  // namespace engram::pipeline

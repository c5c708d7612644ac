// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/adjacency.h"
#include "engram/evaluation/truth.h"

#include <optional>
#include <vector>

namespace engram::evaluation {

/// The places of a map as truth sees them.
struct SurveyedPlaces {
  std::vector<Eigen::Vector3d> positions;  ///< [m] in the frame of the truth
  belief::Adjacency adjacency;
};

/// An answer against true poses, in places and in metres.
struct PlaceError {
  int truePlace = -1;                   ///< the place nearest to the true position
  double truePeak = -1.0;               ///< the same between places: its projection on the chain
  int hops = -1;                        ///< from the answer to the true place; -1 when out of reach
  double places = 0.0;                  ///< sub-place error (F-E14): see placeError()
  double metres = 0.0;                  ///< from the place answered to the true position
  Verdict verdict = Verdict::kUnknown;  ///< right: hops <= 1 + margin, or metres <= radius
};

/// @param place the place answered.
/// @param peak  its interpolated position along the chain, BayesFilter::interpolatedPeak().
///
/// `places` is |peak - truePeak| where answer and truth lie on one stretch of the chain, and `hops` where the
/// way between them leaves it (over a loop edge); infinite when out of reach. F-26 asks for at most 1.25.
/// None when the truth has no position for this stamp or there are no places.
std::optional<PlaceError> placeError(const Truth& truth, double stamp, const SurveyedPlaces& places,
                                     int place, double peak);

/// Number along the chain of the point nearest to `position` on the segments that join the nearest place with
/// its predecessor and successor.
double chainPosition(const SurveyedPlaces& places, int nearest, const Eigen::Vector3d& position);

}  // namespace engram::evaluation

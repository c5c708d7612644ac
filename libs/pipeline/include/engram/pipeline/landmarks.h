// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"
#include "engram/types/match.h"

#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

namespace engram::pipeline {

// Remembered features as landmarks: a place knows how far its features are once a second view, from a known
// way off, has matched them. `T_place_view` is the way of the camera, seen from where it was at the place.

/// A point that a view and a place both see.
struct Landmark {
  types::Match match;    ///< a = feature of the view, b = of the place
  double fromView = 0;   ///< distance [m]
  double fromPlace = 0;  ///< [m]
};

/// The matches whose two rays are at least `parallax` [rad] from parallel and meet in front of both ends.
std::vector<Landmark> triangulated(const types::Features& view, const types::Features& place,
                                   std::span<const types::Match> matches,
                                   const Eigen::Isometry3d& T_place_view, double parallax);

/// A measured length and its standard deviation [m].
struct Length {
  double metres = 0;
  double sigma = 0;
};

/// How far a view is from a place: what two-view geometry cannot tell, and points whose distance from the
/// place is known can.
/// @param matches verified. @param R_place_view, direction_place as two-view geometry found them
/// @returns none where too few points are known, or where they do not agree
std::optional<Length> lengthOf(const types::Features& view, const types::Features& place,
                               std::span<const types::Match> matches, const Eigen::Matrix3d& R_place_view,
                               const Eigen::Vector3d& direction_place);

/// The view as the place would see it: bearings turned into the frame of the place, which is what memory
/// keeps.
types::Features inPlaceFrame(types::Features view, const Eigen::Matrix3d& R_place_view);

/// The same where the way between is known: the points are moved by it, too. Verified matches are
/// triangulated; any other feature is taken to be as far as the matched ones that are seen beside it. Where
/// nothing can be triangulated the way is too short to matter, and bearings are turned alone.
types::Features inPlaceFrame(types::Features view, const Eigen::Isometry3d& T_place_view,
                             const types::Features& place, std::span<const types::Match> matches);

}  // namespace engram::pipeline

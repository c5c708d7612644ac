// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "steps.h"

#include <functional>
#include <span>
#include <utility>

namespace engram::pipeline {

// Where places are, and what an image at one means.

/// In known territory the robot may pass a place at this multiple of the spacing before it has left it.
inline constexpr double kLeaveFactor = 1.5;

/// Distance from all places at which an image makes a new one [m].
double spacingHere(const Run& run);

/// A place that the graph has no short way to: to recognise it adds an edge.
bool isClosure(const Run& run, base::PlaceId place);

/// Where odometry puts the robot, seen from a place near the anchor. The robot must be metric().
Eigen::Isometry3d T_place_robot(const Run& run, base::PlaceId place);

/// The place around the anchor that is nearest to the robot by odometry, with its distance [m].
std::optional<std::pair<base::PlaceId, double>> nearestByOdometry(const Run& run);

/// Can the robot have come from the anchor to this place? True when nothing is known of its way.
bool agreesWithMotion(const Run& run, base::PlaceId place);

/// Whether a place is another one than this and those around it, by the graph and by position: two places
/// that nothing has joined yet may stand side by side.
std::function<bool(base::PlaceId)> farFrom(const Run& run, base::PlaceId place);

/// Whether a verified view may be of this place: a leap through the map needs as much evidence as a loop
/// closure.
bool fitsWay(const Run& run, const Link& link);
/// Whether it is of this place, or of a new one beside it (F-07); a closure needs the matches of one.
bool fitsTerrain(const Run& run, const Link& link);

/// Relative pose of where the robot is, seen from a place: as both eyes measured it; else by odometry; else
/// the direction of the two-view geometry, one spacing long (F-05: planar motion up to scale).
types::RelPose motionFrom(const Run& run, base::PlaceId from, std::span<const Link> links);

/// Where the robot is, seen from the place that it is recognised at: as both eyes measured it; else at the
/// place itself, unless odometry knows better.
types::RelPose atPlace(const Run& run, const Link& link);

/// The edge that recognising a far place adds, and its type.
map::Edge closureTo(const Run& run, const Link& link, std::span<const Link> links);
map::EdgeType closureType(const Run& run, base::PlaceId to);

}  // namespace engram::pipeline

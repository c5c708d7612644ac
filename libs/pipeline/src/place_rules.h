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

/// Where odometry puts the robot, in the map, and seen from a place near the anchor. The robot must be
/// metric().
Eigen::Isometry3d T_map_robot(const Run& run);
Eigen::Isometry3d T_place_robot(const Run& run, base::PlaceId place);

/// The same with what is not known of it: the way since the anchor, and the map between.
types::RelPose expectedAt(const Run& run, base::PlaceId place);

/// Whether an image puts the robot at one pose by either of two places that the map joins: it shows a room,
/// and both are in it.
bool onePose(const Run& run, const Link& a, const Link& b);

/// The place around the anchor that is nearest to the robot by odometry, with its distance [m].
std::optional<std::pair<base::PlaceId, double>> nearestByOdometry(const Run& run);

/// Can the robot have come from the anchor to this place? True when nothing is known of its way.
bool agreesWithMotion(const Run& run, base::PlaceId place);

/// What odometry says of the pose that a verified view of a place near the anchor measured.
enum class Agreement { kUnknown, kAgrees, kContradicts };
Agreement withOdometry(const Run& run, const Link& link);

/// Whether so many matches contradict odometry that the robot is in known ground, wherever odometry puts it:
/// an earlier image may have been wrong, or the robot was carried.
bool callsOdometryWrong(const Run& run, const Link& link);

/// Whether a place is another one than this and those around it, by the graph and by position: two places
/// that nothing has joined yet may stand side by side.
std::function<bool(base::PlaceId)> farFrom(const Run& run, base::PlaceId place);

/// Whether a verified view may be of this place: a leap through the map needs as much evidence as a loop
/// closure.
bool fitsWay(const Run& run, const Link& link);
/// Verified matches that a loop closure needs. Where the graph joins both ends and the image measured the
/// whole pose, the graph judges it, and what any place needs suffices.
int closureInliers(Run& run, const Link& link);
/// Whether it is of this place, or of a new one beside it (F-07); in known ground, whether any place is near
/// enough. A closure needs the matches of one.
bool fitsTerrain(Run& run, const Link& link);

/// Whether a keeper of the map has said that these two places are not the same ground.
bool keptApart(const Run& run, base::PlaceId a, base::PlaceId b);

/// Whether an image shows the way from a place to where it was taken.
bool seesWay(base::PlaceId from, std::span<const Link> links);

/// Relative pose of where the robot is, seen from a place: as both eyes measured it; else by odometry,
/// corrected by what one eye saw; else as that saw it, where the place knows how far its features are; else
/// the direction of the two-view geometry, one spacing long (F-05: planar motion up to scale).
types::RelPose motionFrom(const Run& run, base::PlaceId from, std::span<const Link> links);

/// Where the robot is, seen from the place that it is recognised at: as both eyes measured it; else what
/// odometry expects, corrected by what one eye saw; else at about the place itself.
types::RelPose atPlace(const Run& run, const Link& link);

/// The edge that recognising a far place adds, and its type.
map::Edge closureTo(const Run& run, const Link& link, std::span<const Link> links);
/// The same from a place that the robot is known to be at.
map::Edge closureBetween(const Run& run, base::PlaceId place, const types::RelPose& T_place_robot,
                         const Link& link);
map::EdgeType closureType(const Run& run, base::PlaceId to);

}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/place_match.h"
#include "engram/types/rel_pose.h"

#include <optional>

namespace engram::pipeline {

// Where the robot is, seen from a place that one camera recognised. `match` is verified, without a stereo
// camera; `eye` is where the camera is on the robot, in the robot's frame [m].

/// By this image alone, where the place knows how far its features are, or geometry sees no parallax: the
/// robot is where the place was made. Else none.
std::optional<types::RelPose> measuredBy(const PlaceMatch& match, const Eigen::Vector3d& eye);

/// Whether what the image measured can be what was expected.
/// @param expected T_place_robot before the image, with covariance
bool agrees(const PlaceMatch& match, const types::RelPose& expected, const Eigen::Vector3d& eye);

/// What was expected, corrected by what the image measured: rotation, direction, and length where it is
/// known. Where it is not, the mean and covariance of the posterior: a robot that drives past a place sees
/// the direction to it turn, and what odometry expects has a length; but a direction is too far from linear
/// where the robot is nearly at the place for a Kalman update. An image that contradicts what was expected
/// leaves it, less certain than it was.
types::RelPose correctedBy(const PlaceMatch& match, const types::RelPose& expected,
                           const Eigen::Vector3d& eye);

}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "steps.h"

#include <cstdint>
#include <span>

namespace engram::pipeline {

// What the wheels of a drive are worth beside the way from place to place.

/// Holds the odometry of the way since the anchor against what the image tells of it.
void watchOdometry(Run& run, std::span<const Link> links);

/// What the wheels count between two places that measured where the robot is, some metres apart, is as good
/// as what they counted when the map was made: each drive adds it, and the map gets better.
void holdToMap(Run& run, const Link& link);

/// At the end of a drive: the ways of earlier drives and of this one come to one metre. Of odometry alone:
/// closures are short, and what measured them counts in the metres of the map anyway.
/// @param firstEdge the first id of this drive
void agreeOnTheMetre(Run& run, std::uint32_t firstEdge);

}  // namespace engram::pipeline

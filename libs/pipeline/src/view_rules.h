// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "steps.h"

namespace engram::pipeline {

/// An image held against a view of the map; none unless geometry confirms it. The pose is no stiffer than the
/// floor of links.
std::optional<Link> linkTo(const Run& run, const types::Features& image, base::PlaceId view);

/// With the least covariance that a link may have.
types::RelPose floored(const Run& run, types::RelPose T);

/// A link that may tell what nothing else tells.
bool isSure(const Run& run, const Link& link);

/// Where the robot was last: at wake-up, where the drive before ended (K-19). Not for an empty map (K-E12).
base::PlaceId lastPlace(const Run& run);

/// Where an image was taken, as well as can be said before anything is relaxed.
Eigen::Isometry3d guessedPose(const Run& run, const std::vector<Link>& links);

/// The edge of a link, from the view that was recognised to the new one, with the features that both share.
map::Edge edgeOf(const Run& run, const Link& link, base::PlaceId view);

}  // namespace engram::pipeline

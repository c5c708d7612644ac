// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/map_content.h"
#include "engram/types/se3.h"

namespace engram::upkeep {

/// How much is not known of a relative pose [m^2]: variances, one radian counted as one metre.
inline double variance(const types::RelPose& pose) { return pose.cov.trace(); }

/// What an edge says about its other end, seen from `from`.
inline types::RelPose seenFrom(base::PlaceId from, const map::Edge& edge) {
  return edge.a == from ? edge.T_a_b : types::inverse(edge.T_a_b);
}

}  // namespace engram::upkeep

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"
#include "engram/types/rel_pose.h"
#include "engram/types/se3.h"

#include <Eigen/Geometry>

#include <map>
#include <string>
#include <vector>

namespace engram::posegraph {

using base::PlaceId;
using types::adjoint;
using types::compose;
using types::expSe3;
using types::inverse;
using types::logSe3;

/// A measured relative pose.
struct Constraint {
  PlaceId a{}, b{};
  types::RelPose T_a_b{};  ///< pose of b seen from a (K-E1)
  bool robust = false;     ///< it may be false, as a loop closure may: the kernel bounds its pull
};

/// Poses and what was measured between them.
struct Graph {
  std::map<PlaceId, Eigen::Isometry3d> poses;  ///< T_map_place, first guesses; see addMissingPoses()
  std::vector<Constraint> constraints;
};

/// What is wrong with a constraint, in words; empty when it can be used. Without scale only the rotation has
/// to have a positive definite covariance.
std::string brokenRule(const Constraint& constraint);

/// Throws base::Error for a broken constraint, a pose that is not finite, or an end without a pose.
void requireValid(const Graph& graph);

/// Gives every place that a chain of constraints joins to a place with a pose (or, failing that, to the first
/// place, which becomes the origin) a pose along the most certain chain: the one with the smallest sum of
/// variances, where 1 rad counts as `metresPerRadian`. Poses that are there already stay.
void addMissingPoses(Graph& graph, double metresPerRadian = 1.0);

/// Residual of a constraint with scale: Log(T_a_b^-1 T_map_a^-1 T_map_b), translation [m] before rotation
/// [rad] (K-E2).
types::Vector6d residual(const types::RelPose& T_a_b, const Eigen::Isometry3d& T_map_a,
                         const Eigen::Isometry3d& T_map_b);

}  // namespace engram::posegraph

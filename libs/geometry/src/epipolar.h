// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>

namespace engram::geometry {

/// Unit rays of one scene point in two views.
struct BearingPair {
  Eigen::Vector3d a, b;
};

/// Pose of view b seen from view a up to scale: a point at depth d along b is d R_a_b b + s t_a_b in a, with
/// s unknown.
struct TwoViewPose {
  Eigen::Matrix3d R_a_b = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t_a_b = Eigen::Vector3d::UnitX();  ///< unit vector
};

/// E = [t]x R, with a^T E b = 0 for every static point (F-11).
Eigen::Matrix3d essentialOf(const TwoViewPose& pose);

/// Angle between a ray and the epipolar plane of its partner, the larger one of both views [rad].
double angularError(const Eigen::Matrix3d& E_a_b, const BearingPair& pair);

/// Does the point lie in front of both views? Also true for a point so far away that its rays differ by less
/// than `sinTolerance` after the rotation.
bool inFront(const TwoViewPose& pose, const BearingPair& pair, double sinTolerance);

/// Planar motion in a frame with z up: rotation about z, translation in the xy plane. The essential matrix
/// has four entries that are not zero, sin and cos of two angles.
struct PlanarMotion {
  double cosDirection = 1, sinDirection = 0;  ///< of the angle of t_a_b
  double cosBack = 1, sinBack = 0;  ///< of that angle minus the angle of R_a_b: the direction seen from b
  TwoViewPose pose() const;
};

/// The planar motions that explain two pairs, in a frame with z up: none, or up to two.
/// With v = (cos, sin) of the direction and w of the back direction each pair gives one row of A v = B w; the
/// lengths of v and w are one, which leaves a quadratic equation. Both signs of the translation share a
/// solution.
int solvePlanar(const BearingPair& p, const BearingPair& q, std::array<PlanarMotion, 2>& solutions);

/// The essential matrix of 8 or more pairs by linear least squares (Longuet-Higgins 1981, on unit bearings,
/// which need no normalisation), not yet projected to a valid one; none when the pairs do not determine it.
std::optional<Eigen::Matrix3d> solveEssential(std::span<const BearingPair> pairs);

/// The four poses of the nearest valid essential matrix.
std::array<TwoViewPose, 4> decompose(const Eigen::Matrix3d& E_a_b);

}  // namespace engram::geometry

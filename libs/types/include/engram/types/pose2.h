// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace engram::types {

/// A pose in the plane: position [m] and heading [rad].
struct Pose2 {
  double x = 0.0, y = 0.0, heading = 0.0;
};

/// a then b: b is given in the frame of a. Headings come out in [-pi, pi].
Pose2 compose(const Pose2& a, const Pose2& b);
/// Where b is, seen from a; both in one frame.
Pose2 between(const Pose2& a, const Pose2& b);
/// Share s of the way from a to b along the circular arc that joins them (constant twist: exp(s log(a^-1 b))
/// in SE(2)).
Pose2 interpolate(const Pose2& a, const Pose2& b, double s);

Eigen::Isometry3d toIsometry(const Pose2& pose);
/// The part of a 3D pose that lies in the plane: x, y and the heading of its x axis.
Pose2 toPose2(const Eigen::Isometry3d& pose);

}  // namespace engram::types

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <deque>
#include <optional>

namespace engram::pipeline {

/// How long the map is, measured by the wheels of this drive. A wheel radius that is wrong by a hundredth
/// makes a map that is wrong by as much everywhere, and nothing in that drive can tell. The next drive has
/// another error: each is one vote on the length of a metre.
class WayScale {
 public:
  /// An image has told where the robot is in the map.
  /// @param inMap, byWheels its position in the map and by odometry [m]
  /// @param piece of odometry: between two pieces the way is unknown
  void add(const Eigen::Vector3d& inMap, const Eigen::Vector3d& byWheels, int piece);

  /// Length of the map over length by the wheels, as a natural logarithm, and its standard deviation.
  struct Ratio {
    double log = 0, sigma = 0;
  };
  /// None before some ways were measured.
  std::optional<Ratio> ratio() const;

 private:
  struct Fix {
    Eigen::Vector3d inMap, byWheels;
    double way;  ///< by the wheels from fix to fix since the beginning [m]
  };

  std::deque<Fix> fixes_;  // of this piece, as far back as they are of use
  int piece_ = 0;
  int chords_ = 0;
  double fixesOfAll_ = 0;  // pieces
  double mapSquared_ = 0, wheelsSquared_ = 0, product_ = 0;
};

/// Factors that bring the ways of earlier drives and those of this one to one metre: the least squares of a
/// map that rests on so many drives, and this one, each with a wheel radius of its own. Wheels that no radius
/// explains have no vote: what they count are no metres.
struct Stretch {
  double earlier = 1, own = 1;
};
/// @param drives that made the map before, at least one. @param sigma of the wheel radius, over drives
Stretch stretchFor(const WayScale::Ratio& ratio, int drives, double sigma);

}  // namespace engram::pipeline

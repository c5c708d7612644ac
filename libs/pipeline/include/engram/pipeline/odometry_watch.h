// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/params.h"

#include <Eigen/Geometry>

#include <optional>
#include <string>

namespace engram::pipeline {

/// What the wheel odometry of a run was worth, so far.
struct OdometryHealth {
  int steps = 0;           ///< between images that both had odometry
  int leaps = 0;           ///< of these, such as no robot makes: their ways count as unknown
  double fastest = 0;      ///< of the others [m/s]
  double fastestLeap = 0;  ///< [m/s]
  int frozen = 0;          ///< images that moved while the wheels stood

  int compared = 0;            ///< ways of which images told the rotation, too
  double turned = 0;           ///< by the images, on these ways, whatever the sign [rad]
  double headingRatio = 1;     ///< what odometry turned, of what the images did
  double headingResidual = 0;  ///< share of the turning by the images that this ratio does not explain
  int directions = 0;          ///< ways of which images told the direction, too
  double directionCosine = 1;  ///< mean cosine of the angle between that and odometry's
};

enum class OdometryFault {
  kNone,
  kLeaps,      ///< single leaps; the map was made without them
  kTooFast,    ///< more leaps than ways
  kFrozen,     ///< it stands while the images move
  kHeading,    ///< it turns otherwise than the images
  kDirection,  ///< it moves to other sides than the images
};
/// The gravest fault that stands beyond doubt.
OdometryFault faultOf(const OdometryHealth& health);
/// Whether a run is worth little for it.
bool isGrave(const OdometryHealth& health);
/// That fault in one sentence, with what was measured and what to do; empty when there is none.
std::string describe(const OdometryHealth& health);

/// Looks for the faults of wheel odometry: leaps (a counter that was reset, one wild reading), wheels that
/// stand while the images move, wrong units, mirrored axes.
class OdometryWatch {
 public:
  explicit OdometryWatch(const OdometryParams& params) : params_(params) {}

  /// Whether no robot can have come from the last reading to this one. To be called for each image that has
  /// odometry.
  /// @param stamp of the image [s]
  bool leaps(const Eigen::Isometry3d& T_odom_robot, double stamp);
  /// The images moved while the wheels stood.
  void frozen() { ++health_.frozen; }
  /// Compares a way by the wheels with what the images at its ends tell of it.
  /// @param way by odometry. @param R_sight rotation by the images. @param direction of the way by them, of
  /// length one; zero when they tell none. Both in the frame of the way's beginning
  void compare(const Eigen::Isometry3d& way, const Eigen::Matrix3d& R_sight,
               const Eigen::Vector3d& direction);

  const OdometryHealth& health() const { return health_; }

 private:
  struct Reading {
    Eigen::Isometry3d T_odom_robot;
    double stamp;
  };

  OdometryParams params_;
  std::optional<Reading> last_;
  std::optional<Eigen::Vector3d> velocity_;  // [m/s], in the frame of the robot; none after a leap
  OdometryHealth health_;
  double sightSquared_ = 0, wheelsSquared_ = 0, product_ = 0, cosines_ = 0;
};

}  // namespace engram::pipeline

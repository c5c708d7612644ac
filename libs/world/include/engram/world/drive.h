// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/base/rng.h"
#include "engram/types/pose2.h"
#include "engram/world/plan.h"

#include <cstdint>
#include <vector>

namespace engram::world {

using types::Pose2;  // T_world_robot

/// How the robot drives and what its odometry is worth. Section [drive].
struct DriveParams {
  double spacing = 0.5;          ///< between images [m]
  double turn_spacing = 0.5236;  ///< between images when turning on the spot [rad]
  double speed = 0.6;            ///< [m/s]
  double lateral = 0.10;         ///< wander to both sides of the route, one sigma [m]
  double heading = 0.035;        ///< the same for the heading [rad]
  double laps = 1.0;             ///< rounds of a tour without a stop
  // Noise of the odometry: variances grow with the distance driven and the angle turned.
  double odometry_distance = 0.02;  ///< along the motion [m] after 1 m
  double odometry_lateral = 0.005;  ///< across the motion [m] after 1 m
  double odometry_heading = 0.01;   ///< heading [rad] after 1 m
  double odometry_turn = 0.02;      ///< heading [rad] after turning 1 rad
  double odometry_scale = 0.01;     ///< error of the wheel radius, one sigma over drives (unit-less)
  double odometry_rate = 10;        ///< [Hz]
  void describe(base::Params& p);
};

/// The nominal tour: the plan's route with rounded corners, as a closed curve of arc length.
class Route {
 public:
  explicit Route(const Plan& plan);
  double length() const { return length_; }  ///< [m]
  /// Pose at arc length s, any real number; the heading is the tangent.
  Pose2 at(double s) const;
  /// Stations about one metre apart; station k is at arc length k * pitch().
  int stations() const { return stations_; }
  double pitch() const { return length_ / stations_; }
  int stationAt(double s) const;
  /// Free width to the left (+1) or right (-1) of s, up to 1 m.
  double freeWidth(double s, int side) const;

 private:
  std::vector<Pose2> curve_;  // equally spaced
  std::vector<double> left_, right_;
  double length_ = 0;
  int stations_ = 1;
};

enum class DriveKind : std::uint8_t {
  kTour,  ///< DriveParams::laps times round the route from its start
  kTest,  ///< from another start, aside of the route, part of it back in the other direction
};

/// One drive: true poses, times of the images, odometry. A value of its inputs and seed.
class Drive {
 public:
  Drive(const Route& route, const DriveParams& params, DriveKind kind, std::uint64_t seed);

  double duration() const { return states_.back().t; }  ///< [s]
  Pose2 poseAt(double t) const;                         ///< T_world_robot; t from the start [s]
  double arcLengthAt(double t) const;                   ///< on the route [m]
  Pose2 odometryAt(double t) const;                     ///< T_odom_robot; starts at zero
  const std::vector<double>& imageTimes() const { return imageTimes_; }
  struct Tick {
    double t;
    Pose2 pose;
  };
  /// Readings of the wheels at the odometry's rate.
  const std::vector<Tick>& odometry() const { return odometry_; }

 private:
  struct State {
    double t;
    Pose2 pose;
    double s;
  };
  void follow(const Route& route, double from, double to, base::Rng rng, double bias, double wobble);
  void turnTo(double heading);
  void takeImages();
  void readWheels(base::Rng rng);
  State stateAt(double t) const;

  DriveParams params_;
  std::vector<State> states_;
  std::vector<double> imageTimes_;
  std::vector<Tick> odometry_;
};

}  // namespace engram::world

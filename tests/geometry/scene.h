// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/types/features.h"
#include "engram/types/match.h"
#include "epipolar.h"

#include <Eigen/Geometry>

#include <cmath>
#include <vector>

namespace engram::geometry::testing_scene {

/// The world camera: z down, so the robot's up axis is -z.
inline const Eigen::Vector3d kUp(0, 0, -1);

inline double deg(double degrees) { return degrees * M_PI / 180; }

inline Eigen::Vector3d randomUnit(base::Rng& rng) {
  return Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
}

/// A point of a room of 12 m around the camera, 1.2 m below to 2 m above it (z down), or `height` times that.
inline Eigen::Vector3d roomPoint(base::Rng& rng, double height = 1) {
  const double azimuth = rng.uniform(0, 2 * M_PI), distance = rng.uniform(1.5, 6);
  return {distance * std::cos(azimuth), distance * std::sin(azimuth), height * rng.uniform(-2, 1.2)};
}

/// The ray turned by Gaussian noise of `sigma` [rad] along each axis.
inline Eigen::Vector3d noisy(const Eigen::Vector3d& ray, double sigma, base::Rng& rng) {
  const Eigen::Vector3d u = ray.unitOrthogonal(), v = ray.cross(u);
  return (ray + rng.normal(0, sigma) * u + rng.normal(0, sigma) * v).normalized();
}

struct Scene {
  TwoViewPose truth;
  double distance = 0;  ///< between the views [m]
  std::vector<BearingPair> pairs;
  std::vector<bool> right;
};

struct SceneOptions {
  int points = 200;
  double inlierShare = 1;
  double sigma = 0;       ///< [rad]
  double distance = 0.5;  ///< [m]
  bool planar = true;
  double height = 1;  ///< of the room, relative
};

inline Scene makeScene(const SceneOptions& options, base::Rng& rng) {
  Scene scene;
  scene.distance = options.distance;
  const Eigen::Vector3d axis = options.planar ? kUp : randomUnit(rng);
  scene.truth.R_a_b = Eigen::AngleAxisd(rng.uniform(-M_PI, M_PI), axis).toRotationMatrix();
  const double direction = rng.uniform(-M_PI, M_PI);
  scene.truth.t_a_b =
      options.planar ? Eigen::Vector3d(std::cos(direction), std::sin(direction), 0) : randomUnit(rng);
  for (int i = 0; i < options.points; ++i) {
    const Eigen::Vector3d inA = roomPoint(rng, options.height);
    const Eigen::Vector3d inB = scene.truth.R_a_b.transpose() * (inA - scene.distance * scene.truth.t_a_b);
    const bool right = i < options.inlierShare * options.points;
    const Eigen::Vector3d rayB = right ? inB : roomPoint(rng, options.height);
    scene.pairs.push_back(
        {noisy(inA.normalized(), options.sigma, rng), noisy(rayB.normalized(), options.sigma, rng)});
    scene.right.push_back(right);
  }
  return scene;
}

struct Views {
  types::Features a, b;
  std::vector<types::Match> matches;
};

inline Views toViews(const Scene& scene) {
  Views views;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    views.a.keypoints.emplace_back();
    views.b.keypoints.emplace_back();
    views.a.bearings.push_back(scene.pairs[i].a.cast<float>());
    views.b.bearings.push_back(scene.pairs[i].b.cast<float>());
    views.matches.push_back({static_cast<int>(i), static_cast<int>(i), 0.f});
  }
  return views;
}

inline double rotationError(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

/// Between directions, sign included.
inline double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace engram::geometry::testing_scene

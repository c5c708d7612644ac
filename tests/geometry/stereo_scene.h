// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/geometry/stereo_verify.h"
#include "scene.h"

namespace engram::geometry::testing_scene {

/// K's stereo head: 640 x 480, 90 degrees, 9 cm.
inline const types::StereoModel kModel{320, 319.5, 239.5, 0.09};

struct StereoScene {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  std::vector<StereoMatch> matches;
  std::vector<bool> right;
};

struct StereoSceneOptions {
  int points = 200;
  double inlierShare = 1;
  double sigma = 0;       ///< [px]
  double distance = 0.3;  ///< [m]
};

inline Eigen::Isometry3d randomMotion(double angle, double distance, base::Rng& rng) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(angle, randomUnit(rng)).toRotationMatrix();
  T.translation() = distance * randomUnit(rng);
  return T;
}

/// d with T = exp(d) to first order: translation, rotation vector.
inline Eigen::Matrix<double, 6, 1> smallMotion(const Eigen::Isometry3d& T) {
  const Eigen::AngleAxisd turn(T.linear());
  Eigen::Matrix<double, 6, 1> d;
  d << T.translation(), turn.angle() * turn.axis();
  return d;
}

inline types::StereoPoint noisy(const types::StereoPoint& p, double sigma, base::Rng& rng) {
  const double left = p.u + rng.normal(0, sigma), right = p.u - p.disparity + rng.normal(0, sigma);
  return {left, p.v + rng.normal(0, sigma), std::max(left - right, 0.01)};
}

inline StereoScene withNoise(StereoScene scene, double sigma, base::Rng& rng) {
  for (auto& match : scene.matches) match = {noisy(match.a, sigma, rng), noisy(match.b, sigma, rng)};
  return scene;
}

/// Points 1 to 8 m before the camera.
inline Eigen::Vector3d pointInView(base::Rng& rng) {
  const double z = 1 / rng.uniform(1 / 8.0, 1);
  return {z * rng.uniform(-0.9, 0.9), z * rng.uniform(-0.7, 0.7), z};
}

inline StereoScene makeStereoScene(const StereoSceneOptions& options, base::Rng& rng) {
  StereoScene scene;
  scene.T_a_b = randomMotion(deg(8), options.distance, rng);
  for (int i = 0; i < options.points; ++i) {
    const bool right = i < options.inlierShare * options.points;
    Eigen::Vector3d inA, inB;
    do {
      inA = pointInView(rng);
      inB = right ? scene.T_a_b.inverse() * inA : pointInView(rng);
    } while (inB.z() < 0.5);
    scene.matches.push_back({kModel.project(inA), kModel.project(inB)});
    scene.right.push_back(right);
  }
  return withNoise(scene, options.sigma, rng);
}

struct StereoViews {
  types::Features a, b;
  std::vector<types::Match> matches;
};

inline StereoViews toStereoViews(const StereoScene& scene) {
  StereoViews views;
  const auto add = [](types::Features& to, const types::StereoPoint& p) {
    to.keypoints.push_back({.x = static_cast<float>(p.u), .y = static_cast<float>(p.v)});
    to.ranges.push_back(types::rangeOf(p, kModel));
  };
  for (const auto& [a, b] : scene.matches) {
    const int i = static_cast<int>(views.matches.size());
    add(views.a, a);
    add(views.b, b);
    views.matches.push_back({i, i, 0.f});
  }
  return views;
}

}  // namespace engram::geometry::testing_scene

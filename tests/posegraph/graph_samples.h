// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/posegraph/graph.h"

#include <cmath>
#include <string>

namespace engram::posegraph {

using Vector6d = Eigen::Matrix<double, 6, 1>;

inline PlaceId p(std::uint32_t v) { return PlaceId(v); }

inline Eigen::Isometry3d planarPose(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0;
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// A random symmetric positive definite covariance with standard deviations around `sigma`, correlated.
inline types::Matrix6d randomCovariance(base::Rng& rng, double sigma) {
  types::Matrix6d A;
  for (int i = 0; i < 36; ++i) A(i) = rng.normal(0, 0.3);
  A += types::Matrix6d::Identity();
  const types::Matrix6d cov = sigma * sigma * A * A.transpose();
  return (cov + cov.transpose()) / 2;
}

inline Vector6d randomMotion(base::Rng& rng, double metres, double radians, bool planar = false) {
  Vector6d v;
  for (int i = 0; i < 3; ++i) v[i] = rng.normal(0, metres);
  for (int i = 3; i < 6; ++i) v[i] = rng.normal(0, radians);
  if (planar) v[2] = v[3] = v[4] = 0;
  return v;
}

inline Constraint constraint(std::uint32_t a, std::uint32_t b, const Eigen::Isometry3d& T,
                             const types::Matrix6d& cov, bool robust = false) {
  return {.a = p(a), .b = p(b), .T_a_b = {.T_a_b = T, .cov = cov}, .robust = robust};
}

inline types::Matrix6d isotropic(double metres, double radians) {
  types::Matrix6d cov = types::Matrix6d::Zero();
  cov.diagonal() << metres * metres, metres * metres, metres * metres, radians * radians, radians * radians,
      radians * radians;
  return cov;
}

/// A drive around a circle with noisy odometry and closures: `truth` holds where the places are.
struct Sample {
  Graph graph;
  std::map<PlaceId, Eigen::Isometry3d> truth;
};

inline Sample noisyLoop(std::uint64_t seed, std::uint32_t n, bool planar, double metres, double radians) {
  base::Rng rng(seed);
  Sample s;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n;
    s.truth[p(i)] = planarPose(5 * std::cos(a), 5 * std::sin(a), a + M_PI / 2);
    if (!planar) s.truth[p(i)] = s.truth[p(i)] * expSe3(randomMotion(rng, 0.3, 0.2));
  }
  const auto measure = [&](std::uint32_t a, std::uint32_t b) {
    const Eigen::Isometry3d T =
        s.truth[p(a)].inverse() * s.truth[p(b)] * expSe3(randomMotion(rng, metres, radians, planar));
    s.graph.constraints.push_back(
        constraint(a, b, T, randomCovariance(rng, 0.5 * (metres + radians)), a > b));
  };
  for (std::uint32_t i = 0; i + 1 < n; ++i) measure(i, i + 1);
  measure(n - 1, 0);
  for (std::uint32_t k = 0; k < n / 2; ++k) {
    const auto a = rng.below(n), b = rng.below(n);
    if (a != b) measure(a, b);
  }
  s.graph.poses[p(0)] = s.truth[p(0)];
  return s;
}

/// The sum that is minimised, without kernels.
inline double chi2(const Graph& g, const std::map<PlaceId, Eigen::Isometry3d>& poses) {
  double sum = 0;
  for (const Constraint& c : g.constraints) {
    const Vector6d e = residual(c.T_a_b, poses.at(c.a), poses.at(c.b));
    sum += e.dot(c.T_a_b.cov.inverse() * e);
  }
  return sum;
}

}  // namespace engram::posegraph

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problems.h"

#include "conic.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace engram::geometry {
namespace {

std::vector<BearingPair> rotated(std::span<const BearingPair> pairs, const Eigen::Matrix3d& R) {
  std::vector<BearingPair> out;
  out.reserve(pairs.size());
  for (const auto& pair : pairs) out.push_back({R * pair.a, R * pair.b});
  return out;
}

int countOneByOne(std::span<const BearingPair> pairs, const Eigen::Matrix3d& E, const InlierTest& test) {
  return static_cast<int>(
      std::count_if(pairs.begin(), pairs.end(), [&](const auto& p) { return test(E, p); }));
}

}  // namespace

bool InlierTest::operator()(const Eigen::Matrix3d& E, const BearingPair& pair) const {
  const Eigen::Vector3d planeOfB = E * pair.b;
  if (conic) {
    const Eigen::Matrix3d C = epipolarConic(R_optics_ray * planeOfB.normalized(), xi);
    return conicDistance(C, toNormalisedPlane(R_optics_ray * pair.a, xi)) <= maxConicDistance;
  }
  const double e = pair.a.dot(planeOfB);
  if (!(e * e <= sine * sine * planeOfB.squaredNorm())) return false;
  return e * e <= sine * sine * (E.transpose() * pair.a).squaredNorm();
}

PairArrays::PairArrays(std::span<const BearingPair> pairs) {
  for (auto* v : {&ax, &ay, &az, &bx, &by, &bz}) v->reserve(pairs.size());
  for (const auto& [a, b] : pairs) {
    ax.push_back(static_cast<float>(a.x()));
    ay.push_back(static_cast<float>(a.y()));
    az.push_back(static_cast<float>(a.z()));
    bx.push_back(static_cast<float>(b.x()));
    by.push_back(static_cast<float>(b.y()));
    bz.push_back(static_cast<float>(b.z()));
  }
}

PlanarProblem::PlanarProblem(std::span<const BearingPair> pairs, const Eigen::Matrix3d& R_cam_level,
                             const InlierTest& test)
    : pairs_(pairs),
      level_(rotated(pairs, R_cam_level.transpose())),
      R_cam_level_(R_cam_level),
      test_(test),
      arrays_(level_) {}

int PlanarProblem::solve(const std::array<int, 2>& sample, std::array<Model, 2>& models) const {
  return solvePlanar(level_[static_cast<std::size_t>(sample[0])], level_[static_cast<std::size_t>(sample[1])],
                     models);
}

TwoViewPose PlanarProblem::poseInCamera(const Model& model) const {
  const TwoViewPose level = model.pose();
  return {R_cam_level_ * level.R_a_b * R_cam_level_.transpose(), R_cam_level_ * level.t_a_b};
}

int PlanarProblem::countInliers(const Model& model) const {
  if (test_.conic) return countOneByOne(pairs_, essentialOf(poseInCamera(model)), test_);
  const auto cd = static_cast<float>(model.cosDirection), sd = static_cast<float>(model.sinDirection);
  const auto cb = static_cast<float>(model.cosBack), sb = static_cast<float>(model.sinBack);
  const auto limit = static_cast<float>(test_.sine * test_.sine);
  const float *ax = arrays_.ax.data(), *ay = arrays_.ay.data(), *az = arrays_.az.data();
  const float *bx = arrays_.bx.data(), *by = arrays_.by.data(), *bz = arrays_.bz.data();
  int count = 0;
  for (std::size_t i = 0; i < level_.size(); ++i) {
    const float g = ax[i] * sd - ay[i] * cd;  // E^T a = (-az sb, az cb, g)
    const float h = by[i] * cb - bx[i] * sb;  // E b = (bz sd, -bz cd, h)
    const float e = bz[i] * g + az[i] * h;
    const float shorter = std::min(bz[i] * bz[i] + h * h, az[i] * az[i] + g * g);
    count += e * e <= limit * shorter;
  }
  return count;
}

EssentialProblem::EssentialProblem(std::span<const BearingPair> pairs, const InlierTest& test)
    : pairs_(pairs), test_(test), arrays_(pairs) {}

int EssentialProblem::solve(const std::array<int, 8>& sample, std::array<Model, 1>& models) const {
  std::array<BearingPair, 8> pairs;
  for (std::size_t i = 0; i < 8; ++i) pairs[i] = pairs_[static_cast<std::size_t>(sample[i])];
  const auto E = solveEssential(pairs);
  if (!E) return 0;
  models[0] = *E;
  return 1;
}

int EssentialProblem::countInliers(const Model& model) const {
  if (test_.conic) return countOneByOne(pairs_, model, test_);
  const Eigen::Matrix3f E = model.cast<float>();
  const float e00 = E(0, 0), e01 = E(0, 1), e02 = E(0, 2), e10 = E(1, 0), e11 = E(1, 1), e12 = E(1, 2),
              e20 = E(2, 0), e21 = E(2, 1), e22 = E(2, 2);
  const auto limit = static_cast<float>(test_.sine * test_.sine);
  const float *ax = arrays_.ax.data(), *ay = arrays_.ay.data(), *az = arrays_.az.data();
  const float *bx = arrays_.bx.data(), *by = arrays_.by.data(), *bz = arrays_.bz.data();
  int count = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const float px = e00 * bx[i] + e01 * by[i] + e02 * bz[i];
    const float py = e10 * bx[i] + e11 * by[i] + e12 * bz[i];
    const float pz = e20 * bx[i] + e21 * by[i] + e22 * bz[i];
    const float qx = e00 * ax[i] + e10 * ay[i] + e20 * az[i];
    const float qy = e01 * ax[i] + e11 * ay[i] + e21 * az[i];
    const float qz = e02 * ax[i] + e12 * ay[i] + e22 * az[i];
    const float e = ax[i] * px + ay[i] * py + az[i] * pz;
    const float shorter = std::min(px * px + py * py + pz * pz, qx * qx + qy * qy + qz * qz);
    count += e * e <= limit * shorter;
  }
  return count;
}

int RotationProblem::solve(const std::array<int, 2>& sample, std::array<Model, 1>& models) const {
  const BearingPair& p = pairs_[static_cast<std::size_t>(sample[0])];
  const BearingPair& q = pairs_[static_cast<std::size_t>(sample[1])];
  if (std::abs(p.a.dot(q.a) - p.b.dot(q.b)) > 4 * sine_) return 0;  // a rotation keeps angles
  const auto frameOf = [](const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
    Eigen::Matrix3d frame;
    frame.col(0) = first;
    frame.col(2) = first.cross(second).normalized();
    frame.col(1) = frame.col(2).cross(first);
    return frame;
  };
  if (p.a.cross(q.a).norm() < 0.01 || p.b.cross(q.b).norm() < 0.01) return 0;
  models[0] = frameOf(p.a, q.a) * frameOf(p.b, q.b).transpose();
  return 1;
}

int RotationProblem::countInliers(const Model& R) const {
  const auto agrees = [&](const BearingPair& pair) {
    return (pair.a - R * pair.b).squaredNorm() <= sine_ * sine_;
  };
  return static_cast<int>(std::count_if(pairs_.begin(), pairs_.end(), agrees));
}

}  // namespace engram::geometry

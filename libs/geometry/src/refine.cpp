// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "refine.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace engram::geometry {
namespace {

constexpr double kSigmaFloor = 1e-6;  // [rad]; keeps the covariance of perfect data from being zero

// The small change of a pose is x = (rotation in frame a, translation) = basis * parameters.
template <int K>
using Basis = Eigen::Matrix<double, 6, K>;

Basis<2> planarBasis(const TwoViewPose& pose, const Eigen::Vector3d& up) {
  Basis<2> basis = Basis<2>::Zero();
  basis.block<3, 1>(0, 0) = up;
  basis.block<3, 1>(3, 1) = up.cross(pose.t_a_b);
  return basis;
}

Basis<5> generalBasis(const TwoViewPose& pose) {
  Basis<5> basis = Basis<5>::Zero();
  basis.block<3, 3>(0, 0).setIdentity();
  basis.block<3, 1>(3, 3) = pose.t_a_b.unitOrthogonal();
  basis.block<3, 1>(3, 4) = pose.t_a_b.cross(basis.block<3, 1>(3, 3));
  return basis;
}

TwoViewPose moved(const TwoViewPose& pose, const Eigen::Matrix<double, 6, 1>& x) {
  const Eigen::Vector3d w = x.head<3>();
  const double angle = w.norm();
  TwoViewPose out = pose;
  if (angle > 0) out.R_a_b = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() * pose.R_a_b;
  out.t_a_b = (pose.t_a_b + x.tail<3>()).normalized();
  return out;
}

double denominatorSquared(const TwoViewPose& pose, const Eigen::Vector3d& a, const Eigen::Vector3d& c) {
  const double ta = pose.t_a_b.dot(a), tc = pose.t_a_b.dot(c);
  return std::max(2 - ta * ta - tc * tc, 1e-6);  // |E b|^2 + |E^T a|^2
}

double cost(std::span<const BearingPair> pairs, const TwoViewPose& pose) {
  const Eigen::Matrix3d E = essentialOf(pose);
  double sum = 0;
  for (const auto& pair : pairs) {
    const double e = pair.a.dot(E * pair.b);
    sum += e * e / denominatorSquared(pose, pair.a, pose.R_a_b * pair.b);
  }
  return sum;
}

template <int K>
struct NormalEquations {
  Eigen::Matrix<double, K, K> H = Eigen::Matrix<double, K, K>::Zero();
  Eigen::Matrix<double, K, 1> g = Eigen::Matrix<double, K, 1>::Zero();
};

template <int K>
NormalEquations<K> linearise(std::span<const BearingPair> pairs, const TwoViewPose& pose,
                             const Basis<K>& basis) {
  NormalEquations<K> out;
  const Eigen::Vector3d& t = pose.t_a_b;
  for (const auto& [a, b] : pairs) {
    const Eigen::Vector3d c = pose.R_a_b * b;
    const double e = a.dot(t.cross(c)), D = denominatorSquared(pose, a, c);
    const double scale = 1 / std::sqrt(D), tc = t.dot(c), curl = e * scale / D;
    Eigen::Matrix<double, 6, 1> J;
    J.head<3>() = c.cross(scale * a.cross(t) + curl * tc * t);
    J.tail<3>() = scale * c.cross(a) + curl * (tc * c + t.dot(a) * a);
    const Eigen::Matrix<double, K, 1> j = basis.transpose() * J;
    out.H.noalias() += j * j.transpose();
    out.g += e * scale * j;
  }
  return out;
}

/// Covariance of the parameters to that of d = (R^T dt, R^T rotation): the perturbation on the right, in
/// frame b.
template <int K>
types::Matrix6d toRelPoseCovariance(const Eigen::Matrix<double, K, K>& cov, const Basis<K>& basis,
                                    const Eigen::Matrix3d& R_a_b) {
  Eigen::Matrix<double, 6, K> L;
  L.template topRows<3>() = R_a_b.transpose() * basis.template bottomRows<3>();
  L.template bottomRows<3>() = R_a_b.transpose() * basis.template topRows<3>();
  return L * cov * L.transpose();
}

template <int K, class MakeBasis>
TwoViewEstimate minimise(std::span<const BearingPair> pairs, TwoViewPose pose, int maxIterations,
                         const MakeBasis& makeBasis) {
  double current = cost(pairs, pose);
  double damping = 1e-6;
  Basis<K> basis = makeBasis(pose);
  NormalEquations<K> normal = linearise<K>(pairs, pose, basis);
  for (int i = 0; i < maxIterations; ++i) {
    Eigen::Matrix<double, K, K> damped = normal.H;
    damped.diagonal() *= 1 + damping;
    damped.diagonal().array() += 1e-12;
    const Eigen::Matrix<double, K, 1> step = -damped.ldlt().solve(normal.g);
    const TwoViewPose next = moved(pose, basis * step);
    const double value = cost(pairs, next);
    if (!(value < current)) {
      damping *= 100;
      if (damping > 1e6 || step.norm() < 1e-9) break;
      continue;
    }
    const bool converged = current - value < 1e-6 * current || step.norm() < 1e-7;
    pose = next;
    current = value;
    damping = std::max(1e-9, damping * 0.1);
    basis = makeBasis(pose);
    normal = linearise<K>(pairs, pose, basis);
    if (converged) break;
  }
  TwoViewEstimate out{pose};
  const double freedom = std::max(1.0, static_cast<double>(pairs.size()) - K);
  out.sigma = std::max(kSigmaFloor, std::sqrt(current / freedom));
  normal.H.diagonal().array() +=
      1e-9;  // directions that no pair constrains: a large variance, not an infinite one
  const Eigen::Matrix<double, K, K> cov = out.sigma * out.sigma * normal.H.inverse();
  out.cov = toRelPoseCovariance<K>(cov, basis, pose.R_a_b);
  return out;
}

Eigen::Matrix3d bestRotation(std::span<const BearingPair> pairs, const std::vector<bool>& use,
                             const std::optional<Eigen::Vector3d>& up, const Eigen::Matrix3d& start) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();  // of a c^T
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (use[i]) sum += pairs[i].a * (start * pairs[i].b).transpose();
  if (up) {  // maximise sum a . Rot(up, angle) c
    const Eigen::Matrix3d skew = sum - sum.transpose();
    const double sine = up->dot(Eigen::Vector3d(skew(2, 1), skew(0, 2), skew(1, 0)));
    const double cosine = sum.trace() - up->dot(sum * *up);
    return Eigen::AngleAxisd(std::atan2(sine, cosine), *up).toRotationMatrix() * start;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant();
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose() * start;
}

}  // namespace

TwoViewEstimate refine(std::span<const BearingPair> pairs, const TwoViewPose& start,
                       const std::optional<Eigen::Vector3d>& up, int maxIterations) {
  if (up)
    return minimise<2>(pairs, start, maxIterations,
                       [&](const TwoViewPose& pose) { return planarBasis(pose, *up); });
  return minimise<5>(pairs, start, maxIterations, [](const TwoViewPose& pose) { return generalBasis(pose); });
}

TwoViewEstimate fitRotation(std::span<const BearingPair> pairs, const Eigen::Matrix3d& start,
                            const std::optional<Eigen::Vector3d>& up, double maxAngle) {
  TwoViewEstimate out;
  out.pose = {start, Eigen::Vector3d::Zero()};
  if (pairs.empty()) return out;
  std::vector<bool> use(pairs.size());
  std::vector<double> angles(pairs.size());
  double squares = 0;
  int used = 0;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int round = 0; round < 6; ++round) {  // the nearer half first, then all within the limit
    for (std::size_t i = 0; i < pairs.size(); ++i)
      angles[i] = (pairs[i].a - out.pose.R_a_b * pairs[i].b).norm();
    std::vector<double> sorted = angles;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double limit = std::max(*middle, round < 3 ? 0.0 : maxAngle);
    squares = 0;
    used = 0;
    information.setZero();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      use[i] = angles[i] <= limit;
      if (!use[i]) continue;
      ++used;
      squares += angles[i] * angles[i];
      const Eigen::Vector3d& b = pairs[i].b;
      information += Eigen::Matrix3d::Identity() - b * b.transpose();
    }
    out.pose.R_a_b = bestRotation(pairs, use, up, out.pose.R_a_b);
  }
  // Two axes a pair, each with the noise of two bearings.
  out.sigma = std::max(kSigmaFloor, std::sqrt(squares / (4.0 * std::max(1, used))));
  const double variance = 2 * out.sigma * out.sigma;
  if (up) {
    const Eigen::Vector3d axis = out.pose.R_a_b.transpose() * *up;
    out.cov.bottomRightCorner<3, 3>() =
        variance / std::max(1e-9, axis.dot(information * axis)) * axis * axis.transpose();
  } else {
    information.diagonal().array() += 1e-9;
    out.cov.bottomRightCorner<3, 3>() = variance * information.inverse();
  }
  return out;
}

}  // namespace engram::geometry

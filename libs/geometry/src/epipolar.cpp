// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "epipolar.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace engram::geometry {
namespace {

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

Eigen::Matrix3d essentialOf(const TwoViewPose& pose) { return cross(pose.t_a_b) * pose.R_a_b; }

double angularError(const Eigen::Matrix3d& E, const BearingPair& pair) {
  const Eigen::Vector3d planeOfB = E * pair.b, planeOfA = E.transpose() * pair.a;
  const double length = std::sqrt(std::min(planeOfB.squaredNorm(), planeOfA.squaredNorm()));
  const double sine = std::abs(pair.a.dot(planeOfB)) / std::max(length, 1e-12);
  return std::asin(std::min(1.0, sine));
}

bool inFront(const TwoViewPose& pose, const BearingPair& pair, double sinTolerance) {
  const Eigen::Vector3d c = pose.R_a_b * pair.b;
  const Eigen::Vector3d normal = pair.a.cross(c);
  if (normal.squaredNorm() < sinTolerance * sinTolerance && pair.a.dot(c) > 0) return true;
  // depth_a a = depth_b c + t, solved for both depths by cross products; their denominator is positive.
  return pose.t_a_b.cross(c).dot(normal) > 0 && pose.t_a_b.cross(pair.a).dot(normal) > 0;
}

TwoViewPose PlanarMotion::pose() const {
  const double c = cosDirection * cosBack + sinDirection * sinBack;
  const double s = sinDirection * cosBack - cosDirection * sinBack;
  TwoViewPose pose;
  pose.R_a_b << c, -s, 0, s, c, 0, 0, 0, 1;
  pose.t_a_b = Eigen::Vector3d(cosDirection, sinDirection, 0);
  return pose;
}

int solvePlanar(const BearingPair& p, const BearingPair& q, std::array<PlanarMotion, 2>& solutions) {
  Eigen::Matrix2d A, B;
  A << -p.a.y() * p.b.z(), p.a.x() * p.b.z(), -q.a.y() * q.b.z(), q.a.x() * q.b.z();
  B << -p.b.y() * p.a.z(), p.b.x() * p.a.z(), -q.b.y() * q.a.z(), q.b.x() * q.a.z();
  const double det = A.determinant();
  if (std::abs(det) < 1e-9) return 0;
  Eigen::Matrix2d adjugate;
  adjugate << A(1, 1), -A(0, 1), -A(1, 0), A(0, 0);
  const Eigen::Matrix2d N = adjugate * B / det;  // v = N w
  const Eigen::Matrix2d M = N.transpose() * N;
  // P c^2 + 2 Q c s + S s^2 = 0 from w^T M w = w^T w.
  const double P = M(0, 0) - 1, Q = M(0, 1), S = M(1, 1) - 1;
  double discriminant = Q * Q - P * S;
  const double size = std::max({std::abs(P), std::abs(Q), std::abs(S)});
  if (size < 1e-9) {  // no parallax at all: every direction will do
    solutions[0] = {N(0, 0), N(1, 0), 1, 0};
    return 1;
  }
  // With hardly any parallax noise decides the sign; the double root is the nearest answer.
  if (size < 0.1) discriminant = std::max(0.0, discriminant);
  if (!(discriminant >= 0)) return 0;
  const double q0 = -(Q + std::copysign(std::sqrt(discriminant), Q));
  int count = 0;
  for (const Eigen::Vector2d& root : {Eigen::Vector2d(q0, P), Eigen::Vector2d(S, q0)}) {
    const double length = root.norm();
    if (!(length > 1e-12)) continue;
    const Eigen::Vector2d w = root / length;
    const Eigen::Vector2d v = (N * w).normalized();
    solutions[static_cast<std::size_t>(count++)] = {v.x(), v.y(), w.x(), w.y()};
  }
  return count;
}

std::optional<Eigen::Matrix3d> solveEssential(std::span<const BearingPair> pairs) {
  const auto rowOf = [](const BearingPair& pair) {
    Eigen::Matrix<double, 9, 1> row;
    row << pair.a.x() * pair.b, pair.a.y() * pair.b, pair.a.z() * pair.b;
    return row;
  };
  Eigen::Matrix<double, 9, 1> e;
  if (pairs.size() == 8) {  // the common case inside RANSAC: elimination is several times faster than an SVD
    Eigen::Matrix<double, 8, 9> A;
    for (int i = 0; i < 8; ++i) A.row(i) = rowOf(pairs[static_cast<std::size_t>(i)]);
    const Eigen::FullPivLU<Eigen::Matrix<double, 8, 9>> lu(A);
    if (lu.rank() < 8) return std::nullopt;
    e = lu.kernel().col(0);
  } else {
    Eigen::Matrix<double, 9, 9> M = Eigen::Matrix<double, 9, 9>::Zero();
    for (const auto& pair : pairs) {
      const Eigen::Matrix<double, 9, 1> row = rowOf(pair);
      M += row * row.transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix<double, 9, 9>> svd(M, Eigen::ComputeFullV);
    if (pairs.size() < 8 || svd.singularValues()(7) < 1e-14 * svd.singularValues()(0)) return std::nullopt;
    e = svd.matrixV().col(8);
  }
  Eigen::Matrix3d E;
  E << e.segment<3>(0).transpose(), e.segment<3>(3).transpose(), e.segment<3>(6).transpose();
  return E / e.norm();
}

std::array<TwoViewPose, 4> decompose(const Eigen::Matrix3d& E) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(E, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  if (U.determinant() < 0) U.col(2) *= -1;
  if (V.determinant() < 0) V.col(2) *= -1;
  Eigen::Matrix3d W;
  W << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d R1 = U * W * V.transpose(), R2 = U * W.transpose() * V.transpose();
  const Eigen::Vector3d t = U.col(2);
  return {TwoViewPose{R1, t}, TwoViewPose{R1, -t}, TwoViewPose{R2, t}, TwoViewPose{R2, -t}};
}

}  // namespace engram::geometry

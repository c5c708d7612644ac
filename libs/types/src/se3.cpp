// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/types/se3.h"

#include <cmath>

namespace engram::types {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d skew(const Vector3d& w) {
  Matrix3d m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

Vector6d logSe3(const Eigen::Isometry3d& T) {
  const Eigen::AngleAxisd turn(T.linear());
  const Vector3d w = turn.angle() * turn.axis();
  const double angle = turn.angle();
  const Matrix3d W = skew(w);
  const double k = angle < 1e-4 ? 1.0 / 12 + angle * angle / 720
                                : 1 / (angle * angle) - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  Vector6d v;
  v << T.translation() - 0.5 * (W * T.translation()) + k * (W * (W * T.translation())), w;
  return v;
}

Eigen::Isometry3d expSe3(const Vector6d& v) {
  const Vector3d w = v.tail<3>();
  const double angle = w.norm(), square = angle * angle;
  const Matrix3d W = skew(w);
  const double a = angle < 1e-4 ? 0.5 - square / 24 : (1 - std::cos(angle)) / square;
  const double b = angle < 1e-4 ? 1.0 / 6 - square / 120 : (angle - std::sin(angle)) / (square * angle);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (angle > 0) T.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  T.translation() = v.head<3>() + a * (W * v.head<3>()) + b * (W * (W * v.head<3>()));
  return T;
}

Matrix6d adjoint(const Eigen::Isometry3d& T) {
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = T.linear();
  out.topRightCorner<3, 3>() = skew(T.translation()) * T.linear();
  return out;
}

Matrix3d inverseLeftJacobian(const Vector3d& w) {
  const double square = w.squaredNorm(), angle = std::sqrt(square);
  const double k = angle < 1e-3 ? 1.0 / 12 + square / 720
                                : 1 / square - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  const Matrix3d W = skew(w);
  return Matrix3d::Identity() - 0.5 * W + k * W * W;
}

Matrix6d inverseLeftJacobian(const Vector6d& v) {
  const Matrix3d R = skew(v.head<3>()), W = skew(v.tail<3>());
  const double square = v.tail<3>().squaredNorm(), a = std::sqrt(square);
  double c1 = 1.0 / 6 - square / 120, c2 = 1.0 / 24 - square / 720, c3 = 1.0 / 120 - square / 2520;
  if (a > 0.05) {
    c1 = (a - std::sin(a)) / (square * a);
    c2 = (square + 2 * std::cos(a) - 2) / (2 * square * square);
    c3 = (2 * a - 3 * std::sin(a) + a * std::cos(a)) / (2 * square * square * a);
  }
  const Matrix3d WR = W * R, RW = R * W, WRW = WR * W, WW = W * W;
  const Matrix3d Q =
      0.5 * R + c1 * (WR + RW + WRW) + c2 * (WW * R + R * WW - 3 * WRW) + c3 * (WRW * W + W * WRW);
  const Matrix3d J = inverseLeftJacobian(Vector3d(v.tail<3>()));
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = J;
  out.topRightCorner<3, 3>() = -J * Q * J;
  return out;
}

Matrix6d symmetric(const Matrix6d& m) { return 0.5 * (m + m.transpose()); }

Matrix6d transported(const Matrix6d& cov, const Matrix6d& A) { return symmetric(A * cov * A.transpose()); }

RelPose compose(const RelPose& ab, const RelPose& bc) {
  return {.T_a_b = ab.T_a_b * bc.T_a_b,
          .cov = symmetric(transported(ab.cov, adjoint(bc.T_a_b.inverse())) + bc.cov),
          .hasScale = ab.hasScale && bc.hasScale};
}

RelPose inverse(const RelPose& ab) {
  return {
      .T_a_b = ab.T_a_b.inverse(), .cov = transported(ab.cov, adjoint(ab.T_a_b)), .hasScale = ab.hasScale};
}

RelPose seenBy(const Eigen::Isometry3d& T_a_c, const RelPose& moved) {
  return {.T_a_b = T_a_c * moved.T_a_b * T_a_c.inverse(),
          .cov = transported(moved.cov, adjoint(T_a_c)),
          .hasScale = moved.hasScale};
}

Eigen::Isometry3d rigid(Eigen::Isometry3d T) {
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T;
}

}  // namespace engram::types

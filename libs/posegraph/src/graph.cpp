// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/graph.h"

#include "engram/base/error.h"

#include <Eigen/Cholesky>

#include <cmath>

namespace engram::posegraph {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

Eigen::Matrix3d skew(const Eigen::Vector3d& w) {
  Eigen::Matrix3d m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

}  // namespace

std::string brokenRule(const Constraint& c) {
  const auto& [T_a_b, cov, hasScale] = c.T_a_b;
  if (c.a == c.b) return "it joins a place with itself";
  if (!T_a_b.matrix().allFinite() || !cov.allFinite()) return "its numbers are not finite";
  if ((cov - cov.transpose()).cwiseAbs().maxCoeff() > 1e-9 * cov.cwiseAbs().maxCoeff())
    return "its covariance is not symmetric";
  const bool definite =
      hasScale ? Eigen::LLT<types::Matrix6d>(cov).info() == Eigen::Success
               : Eigen::LLT<Eigen::Matrix3d>(cov.bottomRightCorner<3, 3>()).info() == Eigen::Success;
  return definite ? "" : "its covariance is not positive definite";
}

void requireValid(const Graph& graph) {
  for (const auto& [id, T] : graph.poses)
    if (!T.matrix().allFinite())
      throw base::Error("the pose of place " + std::to_string(id.value) + " is not finite");
  for (const Constraint& c : graph.constraints) {
    std::string rule = brokenRule(c);
    if (rule.empty() && (!graph.poses.contains(c.a) || !graph.poses.contains(c.b)))
      rule = "an end has no pose";
    if (!rule.empty())
      throw base::Error("the constraint from place " + std::to_string(c.a.value) + " to place " +
                        std::to_string(c.b.value) + " cannot be used: " + rule);
  }
}

types::Matrix6d adjoint(const Eigen::Isometry3d& T) {
  types::Matrix6d out = types::Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = T.linear();
  out.topRightCorner<3, 3>() = skew(T.translation()) * T.linear();
  return out;
}

types::RelPose compose(const types::RelPose& ab, const types::RelPose& bc) {
  const types::Matrix6d A = adjoint(bc.T_a_b.inverse());
  return {.T_a_b = ab.T_a_b * bc.T_a_b,
          .cov = A * ab.cov * A.transpose() + bc.cov,
          .hasScale = ab.hasScale && bc.hasScale};
}

types::RelPose inverse(const types::RelPose& ab) {
  const types::Matrix6d A = adjoint(ab.T_a_b);
  return {.T_a_b = ab.T_a_b.inverse(), .cov = A * ab.cov * A.transpose(), .hasScale = ab.hasScale};
}

Vector6d logSe3(const Eigen::Isometry3d& T) {
  const Eigen::AngleAxisd turn(T.linear());
  const Eigen::Vector3d w = turn.angle() * turn.axis();
  const double angle = turn.angle();
  const Eigen::Matrix3d W = skew(w);
  const double k = angle < 1e-4 ? 1.0 / 12 + angle * angle / 720
                                : 1 / (angle * angle) - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  Vector6d v;
  v << T.translation() - 0.5 * (W * T.translation()) + k * (W * (W * T.translation())), w;
  return v;
}

Eigen::Isometry3d expSe3(const Vector6d& v) {
  const Eigen::Vector3d w = v.tail<3>();
  const double angle = w.norm(), square = angle * angle;
  const Eigen::Matrix3d W = skew(w);
  const double a = angle < 1e-4 ? 0.5 - square / 24 : (1 - std::cos(angle)) / square;
  const double b = angle < 1e-4 ? 1.0 / 6 - square / 120 : (angle - std::sin(angle)) / (square * angle);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (angle > 0) T.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  T.translation() = v.head<3>() + a * (W * v.head<3>()) + b * (W * (W * v.head<3>()));
  return T;
}

Vector6d residual(const types::RelPose& T_a_b, const Eigen::Isometry3d& T_map_a,
                  const Eigen::Isometry3d& T_map_b) {
  return logSe3(T_a_b.T_a_b.inverse() * T_map_a.inverse() * T_map_b);
}

}  // namespace engram::posegraph

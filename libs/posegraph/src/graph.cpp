// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/graph.h"

#include "engram/base/error.h"

#include <Eigen/Cholesky>

#include <cmath>

namespace engram::posegraph {
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

types::Vector6d residual(const types::RelPose& T_a_b, const Eigen::Isometry3d& T_map_a,
                         const Eigen::Isometry3d& T_map_b) {
  return logSe3(T_a_b.T_a_b.inverse() * T_map_a.inverse() * T_map_b);
}

}  // namespace engram::posegraph

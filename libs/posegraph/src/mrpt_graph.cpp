// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/mrpt_graph.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace engram::posegraph {
namespace {

constexpr double kMaxPitch = 89.9 * M_PI / 180;

mrpt::poses::CPose3D toMrptPose(const Eigen::Isometry3d& T) {
  return mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(T.matrix()));
}

Eigen::Isometry3d fromMrptPose(const mrpt::poses::CPose3D& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.matrix() = pose.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
  return T;
}

/// Derivative of (x, y, z, yaw, pitch, roll) of T * exp(d) by d at 0.
types::Matrix6d coordinatesByMotion(const Eigen::Isometry3d& T, const mrpt::poses::CPose3D& pose) {
  const double pitch = std::clamp(pose.pitch(), -kMaxPitch, kMaxPitch), roll = pose.roll();
  // Body rates of ZYX Euler angles: w = E (yaw', pitch', roll').
  Eigen::Matrix3d E;
  E << -std::sin(pitch), 0, 1,                              //
      std::sin(roll) * std::cos(pitch), std::cos(roll), 0,  //
      std::cos(roll) * std::cos(pitch), -std::sin(roll), 0;
  types::Matrix6d J = types::Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = T.linear();
  J.bottomRightCorner<3, 3>() = E.inverse();
  return J;
}

}  // namespace

mrpt::graphs::CNetworkOfPoses3DInf toMrpt(const Graph& graph) {
  mrpt::graphs::CNetworkOfPoses3DInf network;
  for (const auto& [id, T] : graph.poses) network.nodes[id.value] = toMrptPose(T);
  if (!graph.poses.empty()) network.root = graph.poses.begin()->first.value;
  for (const Constraint& c : graph.constraints) {
    if (!c.T_a_b.hasScale) continue;
    mrpt::poses::CPose3DPDFGaussianInf edge(toMrptPose(c.T_a_b.T_a_b));
    const types::Matrix6d J = coordinatesByMotion(c.T_a_b.T_a_b, edge.mean);
    const types::Matrix6d information = (J * c.T_a_b.cov * J.transpose()).inverse();
    edge.cov_inv = mrpt::math::CMatrixDouble66(((information + information.transpose()) / 2).eval());
    network.insertEdge(c.a.value, c.b.value, edge);
  }
  return network;
}

Graph fromMrpt(const mrpt::graphs::CNetworkOfPoses3DInf& network) {
  Graph graph;
  for (const auto& [id, pose] : network.nodes)
    graph.poses[PlaceId(static_cast<std::uint32_t>(id))] = fromMrptPose(pose);
  for (const auto& [ends, edge] : network.edges) {
    Constraint c;
    c.a = PlaceId(static_cast<std::uint32_t>(ends.first));
    c.b = PlaceId(static_cast<std::uint32_t>(ends.second));
    c.T_a_b.T_a_b = fromMrptPose(edge.getPoseMean());
    const types::Matrix6d J = coordinatesByMotion(c.T_a_b.T_a_b, edge.getPoseMean());
    const types::Matrix6d information = J.transpose() * edge.cov_inv.asEigen() * J;
    const types::Matrix6d cov = information.inverse();
    c.T_a_b.cov = (cov + cov.transpose()) / 2;
    graph.constraints.push_back(c);
  }
  return graph;
}

}  // namespace engram::posegraph

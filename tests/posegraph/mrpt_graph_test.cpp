// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/mrpt_graph.h"

#include "graph_samples.h"

#include <gtest/gtest.h>

#include <limits>

namespace engram::posegraph {
namespace {

/// Coordinates of T * exp(d) in MRPT, against a numeric derivative through CPose3D.
types::Matrix6d numericCovariance(const Eigen::Isometry3d& T, const types::Matrix6d& cov) {
  const auto coordinates = [&](const Vector6d& d) {
    const mrpt::poses::CPose3D pose(mrpt::math::CMatrixDouble44((T * expSe3(d)).matrix()));
    Vector6d v;
    v << pose.x(), pose.y(), pose.z(), pose.yaw(), pose.pitch(), pose.roll();
    return v;
  };
  types::Matrix6d J;
  const double h = 1e-6;
  for (int i = 0; i < 6; ++i)
    J.col(i) = (coordinates(h * Vector6d::Unit(i)) - coordinates(-h * Vector6d::Unit(i))) / (2 * h);
  return J * cov * J.transpose();
}

TEST(MrptGraph, InformationIsInMrptCoordinates) {
  base::Rng rng(4);
  for (int round = 0; round < 20; ++round) {
    Graph g;
    g.poses = {{p(3), Eigen::Isometry3d::Identity()}, {p(5), expSe3(randomMotion(rng, 1, 0.3))}};
    const Eigen::Isometry3d T = expSe3(randomMotion(rng, 1, 0.4));
    const types::Matrix6d cov = randomCovariance(rng, 0.2);
    g.constraints = {constraint(3, 5, T, cov)};
    const auto network = toMrpt(g);
    ASSERT_EQ(network.edges.size(), 1u);
    const types::Matrix6d information = network.edges.begin()->second.cov_inv.asEigen();
    EXPECT_TRUE(information.isApprox(numericCovariance(T, cov).inverse(), 1e-6)) << "round " << round;
  }
}

TEST(MrptGraph, RoundTripsAndKeepsTheDirection) {
  const Sample s = noisyLoop(3, 8, false, 0.05, 0.02);
  Graph g = s.graph;
  addMissingPoses(g);
  const Graph back = fromMrpt(toMrpt(g));
  ASSERT_EQ(back.poses.size(), g.poses.size());
  for (const auto& [id, T] : g.poses) EXPECT_TRUE(back.poses.at(id).isApprox(T, 1e-9));
  for (const Constraint& c : g.constraints) {
    const auto same =
        std::find_if(back.constraints.begin(), back.constraints.end(), [&](const Constraint& o) {
          return o.a == c.a && o.b == c.b && o.T_a_b.T_a_b.isApprox(c.T_a_b.T_a_b, 1e-9);
        });
    ASSERT_NE(same, back.constraints.end());
    EXPECT_TRUE(same->T_a_b.cov.isApprox(c.T_a_b.cov, 1e-6));
  }
}

/// MRPT sees the same graph as we do: its own composition of root and edge reaches the node.
TEST(MrptGraph, MrptComposesTheEdgesAsWeDo) {
  Graph g;
  g.poses = {{p(0), planarPose(1, 1, M_PI / 2)}, {p(1), planarPose(1, 3, M_PI)}};
  g.constraints = {constraint(0, 1, planarPose(2, 0, M_PI / 2), isotropic(1, 1))};
  auto network = toMrpt(g);
  network.nodes.erase(1);
  network.dijkstra_nodes_estimate();
  EXPECT_NEAR(network.nodes.at(1).x(), 2, 1e-9);  // from a root at the origin
  EXPECT_NEAR(network.nodes.at(1).yaw(), M_PI / 2, 1e-9);
  EXPECT_LT(toMrpt(g).chi2(), 1e-12);
}

TEST(MrptGraph, LeavesOutWhatHasNoScaleAndSurvivesTheSingularity) {
  Graph g;
  g.poses = {{p(0), planarPose(0, 0, 0)}, {p(1), planarPose(1, 0, 0)}};
  g.constraints = {constraint(0, 1, planarPose(1, 0, 0), isotropic(1, 1))};
  g.constraints[0].T_a_b.hasScale = false;
  EXPECT_TRUE(toMrpt(g).edges.empty());
  Eigen::Isometry3d up = Eigen::Isometry3d::Identity();
  up.linear() = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  g.constraints = {constraint(0, 1, up, isotropic(1, 1))};
  EXPECT_TRUE(toMrpt(g).edges.begin()->second.cov_inv.asEigen().allFinite());
}

}  // namespace
}  // namespace engram::posegraph

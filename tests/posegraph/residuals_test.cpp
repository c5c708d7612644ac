// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "residuals.h"

#include "graph_samples.h"

#include <gtest/gtest.h>

namespace engram::posegraph {
namespace {

using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Evaluation {
  Eigen::VectorXd residuals;
  Jacobian by[2];
};

Evaluation evaluate(const ceres::CostFunction& cost, const double* a, const double* b) {
  Evaluation out;
  out.residuals.resize(cost.num_residuals());
  double* jacobians[2];
  for (int i = 0; i < 2; ++i) {
    out.by[i].setConstant(cost.num_residuals(), cost.parameter_block_sizes()[static_cast<std::size_t>(i)],
                          7e7);
    jacobians[i] = out.by[i].data();
  }
  const double* blocks[2] = {a, b};
  EXPECT_TRUE(cost.Evaluate(blocks, out.residuals.data(), jacobians));
  return out;
}

types::RelPose measured(base::Rng& rng, bool planar, bool scale, double metres, double radians) {
  types::RelPose z;
  z.T_a_b = expSe3(randomMotion(rng, metres, radians, planar));
  if (!scale) z.T_a_b.translation().normalize();
  z.cov = randomCovariance(rng, 0.3);
  z.hasScale = scale;
  return z;
}

TEST(Residuals, PlanarDerivativesAreThoseOfCentralDifferences) {
  base::Rng rng(1);
  for (int round = 0; round < 200; ++round) {
    // From gaps of nothing, where the series are used, to half a turn.
    const double size = std::pow(10.0, rng.uniform(-7, 0.3));
    const auto z = measured(rng, true, round % 2 == 0, 1, 0.5);
    const Eigen::Isometry3d Ta = expSe3(randomMotion(rng, 3, 1, true)),
                            Tb = Ta * z.T_a_b * expSe3(randomMotion(rng, size, 0.5 * size, true));
    const auto flat = [](const Eigen::Isometry3d& T) {
      return Eigen::Vector3d(T.translation().x(), T.translation().y(), std::atan2(T(1, 0), T(0, 0)));
    };
    const Eigen::Vector3d x[2] = {flat(Ta), flat(Tb)};
    const auto cost = planarCost(z);
    const Evaluation e = evaluate(*cost, x[0].data(), x[1].data());
    for (int end = 0; end < 2; ++end)
      for (int k = 0; k < 3; ++k) {
        const double h = 1e-6;
        Eigen::Vector3d up[2] = {x[0], x[1]}, down[2] = {x[0], x[1]};
        up[end][k] += h;
        down[end][k] -= h;
        const Eigen::VectorXd slope = (evaluate(*cost, up[0].data(), up[1].data()).residuals -
                                       evaluate(*cost, down[0].data(), down[1].data()).residuals) /
                                      (2 * h);
        EXPECT_LT((slope - e.by[end].col(k)).norm(), 1e-6 * (1 + e.by[end].norm())) << round << " " << size;
      }
  }
}

TEST(Residuals, SpatialDerivativesAreThoseOfCentralDifferences) {
  base::Rng rng(2);
  for (int round = 0; round < 200; ++round) {
    const double size = std::pow(10.0, rng.uniform(-7, 0.2));
    const auto z = measured(rng, false, round % 2 == 0, 1, 0.5);
    const Eigen::Isometry3d Ta = expSe3(randomMotion(rng, 3, 1)),
                            Tb = Ta * z.T_a_b * expSe3(randomMotion(rng, size, 0.5 * size));
    const auto cost = spatialCost(z);
    const PoseBlock a = toBlock(Ta), b = toBlock(Tb);
    const Evaluation e = evaluate(*cost, a.data(), b.data());
    for (int end = 0; end < 2; ++end) {
      EXPECT_EQ(e.by[end].col(6).norm(), 0);
      for (int k = 0; k < 6; ++k) {
        const double h = 1e-6;
        const auto at = [&](double step) {
          const Eigen::Isometry3d move = expSe3(step * Vector6d::Unit(k));
          const PoseBlock ma = toBlock(end == 0 ? Ta * move : Ta), mb = toBlock(end == 1 ? Tb * move : Tb);
          return evaluate(*cost, ma.data(), mb.data()).residuals;
        };
        const Eigen::VectorXd slope = (at(h) - at(-h)) / (2 * h);
        EXPECT_LT((slope - e.by[end].col(k)).norm(), 2e-6 * (1 + e.by[end].norm())) << round << " " << size;
      }
    }
  }
}

/// The whitened residual is the one of residual(): its square is the Mahalanobis distance.
TEST(Residuals, SquareIsTheMahalanobisDistance) {
  base::Rng rng(3);
  for (int round = 0; round < 50; ++round) {
    const auto z = measured(rng, false, true, 1, 0.5);
    const Eigen::Isometry3d Ta = expSe3(randomMotion(rng, 3, 1)), Tb = Ta * expSe3(randomMotion(rng, 1, 0.5));
    const PoseBlock a = toBlock(Ta), b = toBlock(Tb);
    const Vector6d e = residual(z, Ta, Tb);
    const double expected = e.dot(z.cov.inverse() * e);
    EXPECT_NEAR(evaluate(*spatialCost(z), a.data(), b.data()).residuals.squaredNorm(), expected,
                1e-8 * (1 + expected));
  }
}

TEST(Residuals, ManifoldMovesAsTheExponential) {
  base::Rng rng(4);
  const PoseManifold manifold;
  for (int round = 0; round < 50; ++round) {
    const Eigen::Isometry3d T = expSe3(randomMotion(rng, 3, 1));
    const Vector6d d = randomMotion(rng, 1, 0.5);
    const PoseBlock x = toBlock(T);
    PoseBlock y;
    manifold.Plus(x.data(), d.data(), y.data());
    EXPECT_TRUE(fromBlock(y).isApprox(T * expSe3(d), 1e-9));
    Vector6d back;
    manifold.Minus(y.data(), x.data(), back.data());
    EXPECT_LT((back - d).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace engram::posegraph

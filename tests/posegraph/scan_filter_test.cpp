// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/scan_filter.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/posegraph/relaxer.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>

namespace engram::posegraph::scan_filter {
namespace {

using Eigen::Isometry3d;
using types::Matrix6d;
using types::Vector6d;

PlaceId p(std::uint32_t i) { return PlaceId(i); }

Isometry3d planarPose(double x, double y, double yaw) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() << x, y, 0;
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

Matrix6d diagonal(double sigma, double turn) {
  Vector6d v;
  v << sigma * sigma, sigma * sigma, sigma * sigma, turn * turn, turn * turn, turn * turn;
  return v.asDiagonal();
}

/// A pose drawn about a true one.
types::RelPose drawn(const Isometry3d& truth, const Matrix6d& cov, bool planar, base::Rng& rng) {
  Vector6d d = Vector6d::Zero();
  for (const int i : planar ? std::vector{0, 1, 5} : std::vector{0, 1, 2, 3, 4, 5})
    d[i] = rng.normal(0, std::sqrt(cov(i, i)));
  return {.T_a_b = truth * expSe3(-d), .cov = cov};
}

void expectPositiveDefinite(const Eigen::MatrixXd& P) {
  EXPECT_EQ(P, P.transpose());
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(P).info(), Eigen::Success);
}

/// A robot drives a square corridor of 12 m a side twice; each metre a scan, matched with the one before and
/// with references within 1.5 m. Some matches are false.
class Drive {
 public:
  Drive(bool planar, std::uint64_t seed, double falseShare = 0)
      : planar_(planar), falseShare_(falseShare), rng_(seed) {}

  void run(int steps) {
    filter_ = ScanFilter(planar_);
    filter_.start(truth(0));
    for (int k = 1; k <= steps; ++k) step(k);
  }

  Isometry3d truth(int k) const {
    const int along = k % 48, side = along / 12;
    const double s = along % 12 + 0.5;
    const double yaw = side * M_PI / 2;
    const Isometry3d corner = planarPose(side == 1 || side == 2 ? 12 : 0, side >= 2 ? 12 : 0, yaw);
    Isometry3d T = corner * planarPose(s, 0, 0.1 * std::sin(k));
    if (!planar_) {
      T.translation().z() = 0.3 * std::sin(0.26 * k);
      T.linear() =
          T.linear() * Eigen::AngleAxisd(0.1 * std::cos(k), Eigen::Vector3d::UnitY()).toRotationMatrix();
    }
    return T;
  }

  ScanFilter& filter() { return filter_; }
  const std::map<PlaceId, Isometry3d>& truths() const { return truthOf_; }
  int refused() const { return refused_; }
  int falseAccepted() const { return falseAccepted_; }
  Isometry3d T_true_robot() const { return now_; }

  /// Of the robot against its covariance; the errors of the start are nothing.
  double robotNees() const { return nees(filter_.T_map_robot(), now_, filter_.robotCovariance()); }

  double nees(const Isometry3d& T_map, const Isometry3d& T_true, const Eigen::MatrixXd& P) const {
    const Vector6d d = logSe3(T_true * T_map.inverse());
    const Eigen::VectorXd e =
        planar_ ? Eigen::VectorXd(Eigen::Vector3d(d[0], d[1], d[5])) : Eigen::VectorXd(d);
    return e.dot(P.ldlt().solve(e));
  }

 private:
  void step(int k) {
    now_ = truth(k);
    filter_.predict(drawn(truth(k - 1).inverse() * now_, diagonal(0.05, 0.02), planar_, rng_));
    bool matched = false;
    for (const auto& [name, T] : truthOf_)
      if ((T.inverse() * now_).translation().norm() < 1.5) matched |= match(name, T.inverse() * now_);
    if (matched) return;
    match(PlaceId(), truth(k - 1).inverse() * now_);
    const PlaceId name = p(static_cast<std::uint32_t>(truthOf_.size()));
    filter_.promote(name);
    truthOf_[name] = truth(k - 1);
  }

  bool match(PlaceId from, const Isometry3d& T_from_robot) {
    const bool lie = from.valid() && rng_.uniform(0, 1) < falseShare_;
    const Isometry3d off = planarPose(rng_.uniform(2, 4), rng_.uniform(-2, 2), 0);
    const auto z =
        drawn(lie ? Isometry3d(T_from_robot * off) : T_from_robot, diagonal(0.02, 0.01), planar_, rng_);
    const bool accepted = filter_.measure(from, z, 0.99).accepted;
    falseAccepted_ += lie && accepted;
    refused_ += !lie && !accepted;
    return accepted;
  }

  bool planar_;
  double falseShare_;
  base::Rng rng_;
  ScanFilter filter_;
  std::map<PlaceId, Isometry3d> truthOf_;
  Isometry3d now_ = Isometry3d::Identity();
  int refused_ = 0, falseAccepted_ = 0;
};

TEST(ScanFilter, OneDimensionIsTheTextbook) {
  ScanFilter filter;
  filter.start(Isometry3d::Identity(), 1e-6);
  filter.predict({.T_a_b = planarPose(1, 0, 0), .cov = diagonal(0.3, 1e-6)});
  EXPECT_NEAR(filter.robotCovariance()(0, 0), 0.09, 1e-9);
  filter.promote(p(0));
  const auto update =
      filter.measure(p(0), {.T_a_b = planarPose(1.1, 0, 0), .cov = diagonal(0.1, 1e-6)}, 0.99);
  ASSERT_TRUE(update.accepted);
  EXPECT_NEAR(update.chi2, 0.1 * 0.1 / (0.09 + 0.01), 1e-6);
  EXPECT_NEAR(filter.T_map_robot().translation().x(), 1 + 0.1 * 0.09 / 0.1, 1e-6);
  EXPECT_NEAR(filter.robotCovariance()(0, 0), 0.09 * 0.01 / 0.1, 1e-6);
  EXPECT_NEAR(filter.references().at(p(0)).translation().x(), 0, 1e-6) << "the start stays";
}

/// V-09: the scan before becomes a reference by its name alone.
TEST(ScanFilter, PromotionMovesNoNumber) {
  ScanFilter filter;
  filter.start(planarPose(1, 2, 0.3), 0.1);
  filter.predict({.T_a_b = planarPose(1, 0, 0.2), .cov = diagonal(0.1, 0.05)});
  const Isometry3d robot = filter.T_map_robot(), previous = filter.T_map_previous();
  const types::RelPose before = filter.relative(PlaceId());
  filter.promote(p(7));
  EXPECT_FALSE(filter.hasPrevious());
  EXPECT_EQ(filter.T_map_robot().matrix(), robot.matrix());
  EXPECT_EQ(filter.references().at(p(7)).matrix(), previous.matrix());
  EXPECT_EQ(filter.relative(p(7)).cov, before.cov);
  EXPECT_THROW(filter.promote(p(8)), base::Error) << "there is no other";
  filter.predict({.T_a_b = planarPose(1, 0, 0.2), .cov = diagonal(0.1, 0.05)});
  EXPECT_THROW(filter.promote(p(7)), base::Error) << "the name is taken";
  // A scan that is not promoted makes room for the next.
  const auto size = filter.references().size();
  for (int i = 0; i < 5; ++i) filter.predict({.T_a_b = planarPose(1, 0, 0.2), .cov = diagonal(0.1, 0.05)});
  EXPECT_EQ(filter.references().size(), size);
  expectPositiveDefinite(filter.covariance());
}

/// A chain of predictions is what compose() of relative poses says, to first order exactly.
TEST(ScanFilter, PredictionIsThatOfComposedPoses) {
  for (const bool planar : {true, false}) {
    ScanFilter filter(planar);
    filter.start(Isometry3d::Identity(), 1e-7);
    types::RelPose sum{.cov = Matrix6d::Zero()};
    for (int k = 0; k < 6; ++k) {
      const types::RelPose step{.T_a_b = planarPose(0.7, 0.1 * k, 0.4), .cov = diagonal(0.02, 0.01)};
      sum = compose(sum, step);
      filter.predict(step);
      if (k == 0) filter.promote(p(0));
    }
    const types::RelPose found = filter.relative(p(0));
    EXPECT_TRUE(found.T_a_b.isApprox(sum.T_a_b, 1e-9));
    for (const int i : planar ? std::vector{0, 1, 5} : std::vector{0, 1, 2, 3, 4, 5})
      for (const int j : planar ? std::vector{0, 1, 5} : std::vector{0, 1, 2, 3, 4, 5})
        EXPECT_NEAR(found.cov(i, j), sum.cov(i, j), 1e-9) << i << j;
  }
}

/// With small errors the filter and least squares over all that was measured are one.
TEST(ScanFilter, AgreesWithLeastSquares) {
  base::Rng rng(3);
  ScanFilter filter;
  filter.start(Isometry3d::Identity(), 1e-3);
  Graph graph;
  graph.poses[p(0)] = Isometry3d::Identity();
  Isometry3d truth = Isometry3d::Identity();
  for (std::uint32_t k = 1; k < 8; ++k) {
    const Isometry3d step = planarPose(1, 0, 2 * M_PI / 8);
    truth = truth * step;
    const auto wheels = drawn(step, diagonal(0.01, 0.005), true, rng);
    const auto match = drawn(step, diagonal(0.005, 0.002), true, rng);
    filter.predict(wheels);
    filter.promote(p(k - 1));
    ASSERT_TRUE(filter.measure(p(k - 1), match, 0.9999).accepted);
    graph.constraints.push_back({p(k - 1), p(k), wheels});
    graph.constraints.push_back({p(k - 1), p(k), match});
  }
  const auto closure = drawn(truth, diagonal(0.005, 0.002), true, rng);
  ASSERT_TRUE(filter.measure(p(0), closure, 0.9999).accepted);
  graph.constraints.push_back({p(0), p(7), closure});
  filter.predict({.cov = diagonal(1e-4, 1e-4)});
  filter.promote(p(7));
  addMissingPoses(graph);
  RelaxerParams params;
  params.kernel = "none";
  const auto relaxed = makeRelaxer(params)->relax(graph).poses;
  for (const auto& [id, T] : filter.references())
    EXPECT_LT((T.translation() - relaxed.at(id).translation()).norm(), 2e-4) << id.value;
  graph.poses = relaxed;
  const Eigen::MatrixXd batch = jointCovariance(graph, true, 1e-3), ours = filter.covariance();
  EXPECT_LT((batch - ours).norm(), 0.02 * batch.norm());
}

/// NEES over 50 runs: the error of the robot is that which its covariance says, before the loop closes and
/// after. The sum of 50 is chi-square with 50 dof() degrees of freedom; its 99.9 % band.
TEST(ScanFilter, IsConsistentOverFiftyRuns) {
  for (const bool planar : {true, false})
    for (const int steps : {20, 47, 52, 90}) {
      double sum = 0;
      for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        Drive drive(planar, seed);
        drive.run(steps);
        sum += drive.robotNees();
      }
      const double n = 50.0 * (planar ? 3 : 6), band = 3.3 * std::sqrt(2 * n);
      EXPECT_NEAR(sum, n, band) << (planar ? "plane, " : "space, ") << steps << " steps";
    }
}

/// The same of all references together, the correlations included.
TEST(ScanFilter, TheJointCovarianceIsConsistent) {
  double sum = 0, n = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Drive drive(true, seed);
    drive.run(60);
    const Eigen::MatrixXd P = drive.filter().covariance();
    expectPositiveDefinite(P);
    Eigen::VectorXd e(P.rows());
    Eigen::Index row = 0;
    for (const auto& [name, T] : drive.filter().references()) {
      const Vector6d d = logSe3(drive.truths().at(name) * T.inverse());
      e.segment<3>(row) << d[0], d[1], d[5];
      row += 3;
    }
    sum += e.dot(P.ldlt().solve(e));
    n += static_cast<double>(P.rows());
  }
  EXPECT_NEAR(sum / n, 1, 3.3 * std::sqrt(2 / n));
}

TEST(ScanFilter, GateRefusesWhatIsFalseAndOneInAHundredOfTheTrue) {
  int refused = 0, falseAccepted = 0, measured = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Drive drive(true, seed, 0.2);
    drive.run(90);
    refused += drive.refused();
    falseAccepted += drive.falseAccepted();
    measured += 90;
    expectPositiveDefinite(drive.filter().covariance());
    EXPECT_LT((drive.filter().T_map_robot().translation() - drive.T_true_robot().translation()).norm(), 0.8);
  }
  EXPECT_EQ(falseAccepted, 0);
  EXPECT_LT(refused, measured / 30);
}

/// V-10, Fig. 3: uncertainty grows along the way and collapses when the loop closes.
TEST(ScanFilter, EllipsesGrowAndCollapse) {
  const auto areas = [](int steps) {
    Drive drive(true, 5);
    drive.run(steps);
    const auto T = drive.filter().references();
    const Eigen::MatrixXd P = drive.filter().covariance();
    std::vector<double> out;
    Eigen::Index row = 0;
    for (const auto& [name, T_map] : T) {
      out.push_back(std::sqrt(positionCovariance(P.block(row, row, 3, 3), T_map).determinant()));
      row += 3;
    }
    return out;
  };
  const auto open = areas(46), closed = areas(55);
  ASSERT_GT(open.size(), 20u);
  EXPECT_GT(open.back(), 20 * open[2]) << "grows";
  EXPECT_LT(closed[open.size() - 1], 0.3 * open.back()) << "collapses";
  for (std::size_t i = 0; i < open.size(); ++i) EXPECT_LE(closed[i], open[i] * (1 + 1e-9)) << i;
}

TEST(ScanFilter, GoesOnFromWhatWasKept) {
  Drive drive(true, 9);
  drive.run(60);
  const auto poses = drive.filter().references();
  ScanFilter again(true, poses, drive.filter().covariance());
  EXPECT_FALSE(again.located());
  EXPECT_EQ(again.covariance(), drive.filter().covariance());
  EXPECT_THROW(again.T_map_robot(), base::Error);
  again.relocate(p(3), {.T_a_b = planarPose(0.2, 0.1, 0.1), .cov = diagonal(0.02, 0.01)});
  EXPECT_TRUE(again.located());
  EXPECT_TRUE(again.T_map_robot().isApprox(poses.at(p(3)) * planarPose(0.2, 0.1, 0.1), 1e-12));
  const types::RelPose there = again.relative(p(3));
  EXPECT_NEAR(there.cov(0, 0), 4e-4, 1e-9) << "known from the reference as it was measured";
  EXPECT_NEAR(there.cov(5, 5), 1e-4, 1e-9);
  EXPECT_EQ(again.covariance(), drive.filter().covariance()) << "the map has learnt nothing";
}

TEST(ScanFilter, RefusesACovarianceThatIsNone) {
  const std::map<PlaceId, Isometry3d> poses{{p(0), Isometry3d::Identity()}};
  EXPECT_THROW(ScanFilter(true, poses, Eigen::MatrixXd::Identity(6, 6)), base::Error);
  EXPECT_THROW(ScanFilter(true, poses, -Eigen::MatrixXd::Identity(3, 3)), base::Error);
  Eigen::MatrixXd nan = Eigen::MatrixXd::Identity(3, 3);
  nan(1, 1) = std::nan("");
  EXPECT_THROW(ScanFilter(true, poses, nan), base::Error);
}

TEST(JointCovariance, IsThatOfAChain) {
  Graph graph;
  for (std::uint32_t k = 0; k < 4; ++k) graph.poses[p(k)] = planarPose(k, 0, 0);
  for (std::uint32_t k = 1; k < 4; ++k)
    graph.constraints.push_back({p(k - 1), p(k), {.T_a_b = planarPose(1, 0, 0), .cov = diagonal(0.1, 1e-4)}});
  const Eigen::MatrixXd P = jointCovariance(graph, true, 1e-3);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(P(3 * k, 3 * k), 0.01 * k, 1e-4) << k;
  EXPECT_NEAR(P(9, 3), 0.01, 1e-4) << "what they share";
}

}  // namespace
}  // namespace engram::posegraph::scan_filter

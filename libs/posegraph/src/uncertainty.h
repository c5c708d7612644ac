// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/gating.h"
#include "indexed_graph.h"

#include <optional>

namespace engram::posegraph {

/// Chi-square of a gap (6) under a covariance, in the plane or in space.
struct Test {
  double chi2 = 0;
  double sigma = 0;     ///< [m]
  double sigmaYaw = 0;  ///< [rad], of the least known axis
};
Test testGap(const Eigen::Matrix<double, 6, 1>& gap, const types::Matrix6d& known,
             const types::Matrix6d& measured, bool planar);

/// What the trusted constraints alone say about any two places: motions along a tree of the most certain
/// ones, with covariances kept from the root, so that a pair costs the walk to the common ancestor only.
class TrustedTree {
 public:
  explicit TrustedTree(const Graph& trusted, bool planar);
  /// T_i_j; nothing when no trusted chain joins them.
  std::optional<types::RelPose> between(std::uint32_t i, std::uint32_t j) const;
  /// Position in a walk through the tree: near in it are near along odometry, mostly.
  std::uint32_t order(std::uint32_t i) const { return order_[i]; }
  const IndexedGraph& index() const { return index_; }

 private:
  void attach(const Graph& trusted, std::uint32_t parent, std::uint32_t child, std::uint32_t constraint);
  std::uint32_t commonAncestor(std::uint32_t i, std::uint32_t j) const;

  IndexedGraph index_;
  std::vector<std::uint32_t> order_, root_, depth_;
  std::vector<std::vector<std::uint32_t>> up_;  // ancestors 1, 2, 4, ... above
  std::vector<Eigen::Isometry3d> T_root_;
  std::vector<types::Matrix6d> P_;  // covariance from the root, in the frame of the root
};

/// The cycle a1 -> b1 -> b2 -> a2 -> a1 through two closures. `sigma` is that of the trusted chains,
/// inflated. Nothing when a chain is missing.
std::optional<Test> testCycle(const TrustedTree& tree, const Constraint& first, const Constraint& second,
                              const GateParams& params, bool planar);

/// The same of the cycle a -> b -> a of one closure and the chain that it closes.
std::optional<Test> testCycle(const TrustedTree& tree, const Constraint& closure, const GateParams& params,
                              bool planar);

/// Covariance of the current estimate between two places, along the most certain chain.
class ChainFinder {
 public:
  ChainFinder(const Graph& graph, bool planar);
  /// Covariance of T_a_b in the frame of b. Nothing when no chain has less variance than `limit` [m^2].
  std::optional<types::Matrix6d> covariance(std::uint32_t a, std::uint32_t b, double limit);
  const IndexedGraph& index() const { return index_; }

 private:
  const Graph& graph_;
  IndexedGraph index_;
  std::vector<Eigen::Isometry3d> T_map_;
  std::vector<double> variance_;  // of each constraint
  std::vector<double> best_;
  std::vector<std::uint32_t> via_, touched_;
};

}  // namespace engram::posegraph

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <vector>

namespace engram::upkeep {

/// How alike two views are, K eq (4): m / m_e - 1 with m features in the poorer view and m_e inliers of their
/// match. 0 when all match, infinite when none does (K-E7). Not a metric.
double closeness(int features, int inliers);

/// The clusters of K-25: sets of views that chains of pairs with closeness <= tau connect (single linkage; K
/// has < tau in one place and > tau in the other, K-E7).
/// @param closeness symmetric; the diagonal is not looked at
/// @return for each view the index of the first view of its cluster
std::vector<std::size_t> singleLinkage(const Eigen::MatrixXd& closeness, double tau);

}  // namespace engram::upkeep

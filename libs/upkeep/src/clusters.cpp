// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/clusters.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace engram::upkeep {

double closeness(int features, int inliers) {
  if (inliers <= 0) return std::numeric_limits<double>::infinity();
  return static_cast<double>(features) / inliers - 1.0;
}

std::vector<std::size_t> singleLinkage(const Eigen::MatrixXd& closeness, double tau) {
  // Union-find in which every root is the first of its set.
  std::vector<std::size_t> parent(static_cast<std::size_t>(closeness.rows()));
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t i = 0; i < parent.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (closeness(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) > tau) continue;
      const std::size_t a = root(i), b = root(j);
      parent[std::max(a, b)] = std::min(a, b);
    }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root(i);
  return parent;
}

}  // namespace engram::upkeep

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/upkeep/clusters.h"

#include "engram/base/rng.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace engram::upkeep {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Closeness, IsEquationFour) {
  EXPECT_EQ(closeness(300, 300), 0);
  EXPECT_EQ(closeness(300, 30), 9);
  EXPECT_EQ(closeness(300, 80), 2.75);
  EXPECT_EQ(closeness(300, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(closeness(0, 0), std::numeric_limits<double>::infinity());
}

TEST(SingleLinkage, TauItselfIsAMatch) {
  Eigen::MatrixXd c(2, 2);
  c << 0, 9, 9, 0;
  EXPECT_THAT(singleLinkage(c, 9), ElementsAre(0u, 0u));
  EXPECT_THAT(singleLinkage(c, std::nextafter(9, 0)), ElementsAre(0u, 1u));
  EXPECT_THAT(singleLinkage(Eigen::MatrixXd(0, 0), 9), IsEmpty());
}

/// Views that do not match are in one cluster when a chain of matches joins them.
TEST(SingleLinkage, ChainsJoin) {
  const double inf = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd c = Eigen::MatrixXd::Constant(5, 5, inf);
  const auto join = [&](int i, int j) { c(i, j) = c(j, i) = 1; };
  join(4, 2);
  join(0, 4);
  join(1, 3);
  EXPECT_THAT(singleLinkage(c, 9), ElementsAre(0u, 1u, 0u, 1u, 0u));
}

TEST(SingleLinkage, IsTheTransitiveClosure) {
  base::Rng rng(1);
  for (int round = 0; round < 200; ++round) {
    const auto n = static_cast<Eigen::Index>(1 + rng.below(14));
    const double tau = rng.uniform(0, 12);
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < i; ++j) c(i, j) = c(j, i) = rng.uniform(0, 60);
    // Warshall's algorithm.
    Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> joined = c.array() <= tau;
    for (Eigen::Index k = 0; k < n; ++k)
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) joined(i, j) = joined(i, j) || (joined(i, k) && joined(k, j));
    const auto cluster = singleLinkage(c, tau);
    for (Eigen::Index i = 0; i < n; ++i) {
      EXPECT_LE(cluster[static_cast<std::size_t>(i)], static_cast<std::size_t>(i));
      for (Eigen::Index j = 0; j < n; ++j)
        EXPECT_EQ(cluster[static_cast<std::size_t>(i)] == cluster[static_cast<std::size_t>(j)], joined(i, j));
    }
  }
}

}  // namespace
}  // namespace engram::upkeep

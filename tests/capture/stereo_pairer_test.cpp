// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_pairer.h"

#include "engram/base/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

namespace engram::capture {
namespace {

struct Arrival {
  double when;
  int side;
  double stamp;
  int frame;
};

/// Both cameras at 20 Hz with jitter of the clocks, losses, and delays that are not the same on both sides.
std::vector<Arrival> stream(double loss, base::Rng& rng) {
  std::vector<Arrival> arrivals;
  for (int side = 0; side < 2; ++side) {
    double last = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double stamp = 0.05 * i + rng.uniform(-1e-3, 1e-3);
      last = std::max(last, stamp + rng.uniform(0.001, 0.12));  // frames of one camera come in order
      if (rng.uniform() >= loss) arrivals.push_back({last, side, stamp, i});
    }
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const auto& a, const auto& b) { return a.when < b.when; });
  return arrivals;
}

TEST(StereoPairer, JoinsExactlyTheFramesThatBothSidesHave) {
  for (const double loss : {0.0, 0.1, 0.6}) {
    base::Rng rng(3);
    const auto arrivals = stream(loss, rng);
    std::set<int> seen[2];
    for (const auto& a : arrivals) seen[a.side].insert(a.frame);
    std::vector<int> common;
    std::set_intersection(seen[0].begin(), seen[0].end(), seen[1].begin(), seen[1].end(),
                          std::back_inserter(common));

    StereoPairer<int> pairer(0.005);
    std::vector<int> joined;
    for (const auto& a : arrivals) {
      const auto pair = pairer.push(a.side, a.stamp, a.frame);
      if (!pair) continue;
      EXPECT_EQ(pair->left, pair->right);
      EXPECT_NEAR(pair->stamp, 0.05 * pair->left, 1e-3);
      joined.push_back(pair->left);
    }
    EXPECT_EQ(joined, common) << loss;
    // All but the last few, which may still wait, are accounted for.
    const std::size_t alone = arrivals.size() - 2 * common.size();
    EXPECT_LE(pairer.unpaired(), alone);
    EXPECT_GE(pairer.unpaired() + 16, alone);
  }
}

TEST(StereoPairer, ASilentCameraDoesNotFillTheMemory) {
  StereoPairer<int> pairer(0.005);
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(pairer.push(0, 0.05 * i, i));
  EXPECT_EQ(pairer.unpaired(), 992u);
  const auto pair = pairer.push(1, 0.05 * 999, 999);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left, 999);
  EXPECT_EQ(pairer.unpaired(), 999u);
}

TEST(StereoPairer, KeepsTheSidesApart) {
  StereoPairer<char> pairer(0.005);
  EXPECT_FALSE(pairer.push(1, 1.0, 'r'));
  const auto pair = pairer.push(0, 1.004, 'l');
  ASSERT_TRUE(pair);
  EXPECT_EQ(std::tuple(pair->stamp, pair->left, pair->right), std::tuple(1.004, 'l', 'r'));
  EXPECT_FALSE(pairer.push(1, 2.0, 'r'));
  EXPECT_FALSE(pairer.push(0, 2.0051, 'l'));
}

}  // namespace
}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ransac.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace engram::geometry {
namespace {

/// y = m x + c.
struct Line {
  double m = 0, c = 0;
};

struct LineProblem {
  using Model = Line;
  static constexpr int kSampleSize = 2, kMaxModels = 1;
  std::vector<std::pair<double, double>> points;

  int size() const { return static_cast<int>(points.size()); }
  int solve(const std::array<int, 2>& sample, std::array<Line, 1>& models) const {
    const auto [x0, y0] = points[static_cast<std::size_t>(sample[0])];
    const auto [x1, y1] = points[static_cast<std::size_t>(sample[1])];
    if (x0 == x1) return 0;
    const double m = (y1 - y0) / (x1 - x0);
    models[0] = {m, y0 - m * x0};
    return 1;
  }
  int countInliers(const Line& line) const {
    int count = 0;
    for (const auto& [x, y] : points) count += std::abs(line.m * x + line.c - y) < 0.01;
    return count;
  }
};

LineProblem problem(int right, int wrong) {
  base::Rng rng(9);
  LineProblem out;
  for (int i = 0; i < right; ++i) out.points.emplace_back(i, 2.0 * i + 3);
  for (int i = 0; i < wrong; ++i) out.points.emplace_back(rng.uniform(0, 50), rng.uniform(-100, 100));
  return out;
}

TEST(Ransac, FindsTheLineAmongOutliers) {
  const auto result = ransac(problem(30, 70), {.confidence = 0.9999, .maxIterations = 1000, .seed = 3});
  EXPECT_NEAR(result.model.m, 2, 1e-9);
  EXPECT_NEAR(result.model.c, 3, 1e-9);
  EXPECT_GE(result.inliers, 30);
}

TEST(Ransac, StopsWhenTheFormulaSaysSo) {
  EXPECT_NEAR(samplesNeeded(1000000, 500000, 2, 0.99), std::log(0.01) / std::log(0.75), 1e-3);
  EXPECT_NEAR(samplesNeeded(10, 5, 2, 0.9), std::log(0.1) / std::log(1 - 5.0 * 4 / 90), 1e-9);
  EXPECT_EQ(samplesNeeded(10, 10, 2, 0.99), 1);
  EXPECT_GT(samplesNeeded(10, 1, 2, 0.99), 1e17);
  EXPECT_EQ(ransac(problem(50, 0), {}).iterations, 1);
  const auto hard = ransac(problem(10, 190), {.confidence = 0.99, .maxIterations = 77, .seed = 1});
  EXPECT_EQ(hard.iterations, 77);
}

TEST(Ransac, SucceedsAsOftenAsItPromises) {
  const LineProblem lines = problem(30, 70);
  int found = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed)
    found += ransac(lines, {.confidence = 0.95, .maxIterations = 1000, .seed = seed}).inliers >= 30;
  EXPECT_GE(found, 930);
}

TEST(Ransac, SameSeedSameResult) {
  const LineProblem lines = problem(10, 190);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const RansacParams params{.confidence = 0.99, .maxIterations = 20, .seed = seed};
    const auto a = ransac(lines, params), b = ransac(lines, params);
    EXPECT_EQ(a.model.m, b.model.m);
    EXPECT_EQ(a.iterations, b.iterations);
  }
}

TEST(Ransac, NoModelIsAValue) {
  LineProblem vertical;
  EXPECT_EQ(ransac(vertical, {}).inliers, 0);
  for (int i = 0; i < 10; ++i) vertical.points.emplace_back(1, i);
  const auto result = ransac(vertical, {.maxIterations = 50});
  EXPECT_EQ(result.inliers, 0);
  EXPECT_EQ(result.iterations, 50);
}

}  // namespace
}  // namespace engram::geometry

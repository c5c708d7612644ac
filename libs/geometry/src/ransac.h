// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace engram::geometry {

struct RansacParams {
  double confidence = 0.999;  ///< of having drawn one sample without outliers, in (0, 1)
  int maxIterations = 1000;
  std::uint64_t seed = 1;
};

template <class Model>
struct RansacResult {
  Model model{};
  int inliers = 0;     ///< 0 when no sample gave a model
  int iterations = 0;  ///< samples drawn
};

/// Samples that are needed to draw one without outliers, when `inliers` of n are right.
inline double samplesNeeded(int n, int inliers, int sampleSize, double confidence) {
  double good = 1;
  for (int i = 0; i < sampleSize; ++i) good *= static_cast<double>(inliers - i) / (n - i);
  if (good <= 0) return 1e18;
  if (good >= 1) return 1;
  return std::log(1 - confidence) / std::log1p(-good);
}

/// Random sample consensus (Fischler & Bolles 1981) that stops as soon as the best model makes further
/// samples pointless. The same seed gives the same model. A problem has
///
///     using Model = …;  static constexpr int kSampleSize, kMaxModels;
///     int size() const;
///     int solve(const std::array<int, kSampleSize>& sample, std::array<Model, kMaxModels>& models) const;
///     int countInliers(const Model& model) const;
template <class Problem>
RansacResult<typename Problem::Model> ransac(const Problem& problem, const RansacParams& params) {
  RansacResult<typename Problem::Model> best;
  const int n = problem.size();
  if (n < Problem::kSampleSize) return best;
  base::Rng rng(params.seed);
  std::array<int, Problem::kSampleSize> sample{};
  std::array<typename Problem::Model, Problem::kMaxModels> models;
  double needed = params.maxIterations;
  for (; best.iterations < needed; ++best.iterations) {
    for (auto drawn = sample.begin(); drawn != sample.end();) {
      *drawn = static_cast<int>(rng.below(static_cast<std::uint32_t>(n)));
      if (std::find(sample.begin(), drawn, *drawn) == drawn) ++drawn;
    }
    const int count = problem.solve(sample, models);
    for (int m = 0; m < count; ++m) {
      const auto& model = models[static_cast<std::size_t>(m)];
      const int inliers = problem.countInliers(model);
      if (inliers <= best.inliers) continue;
      best.inliers = inliers;
      best.model = model;
      needed = std::min(needed, samplesNeeded(n, inliers, Problem::kSampleSize, params.confidence));
    }
  }
  return best;
}

}  // namespace engram::geometry

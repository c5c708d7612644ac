// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion_models.h"

#include <algorithm>
#include <numeric>

namespace engram::belief {

double nothing(std::size_t places, std::size_t layers, double inSmallMaps) {
  constexpr std::size_t kSmall = 200;
  constexpr double kNothingInAll = 0.01;
  return places <= kSmall ? inSmallMaps : kNothingInAll / static_cast<double>(places * layers);
}

std::vector<double> sums(const Layers& layers) {
  constexpr std::size_t kAtOnce = 4;
  std::vector<double> result(layers.size(), 0.0);
  std::size_t k = 0;
  for (; k + kAtOnce <= layers.size(); k += kAtOnce) {
    double sum[kAtOnce] = {};
    for (std::size_t i = 0; i < layers[k].size(); ++i)
      for (std::size_t l = 0; l < kAtOnce; ++l) sum[l] += layers[k + l][i];
    std::copy_n(sum, kAtOnce, result.begin() + static_cast<std::ptrdiff_t>(k));
  }
  for (; k < layers.size(); ++k) result[k] = std::accumulate(layers[k].begin(), layers[k].end(), 0.0);
  return result;
}

void BlindMotion::move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) {
  const double centre = hint.hops.value_or(params_.expected_hops);
  const double sigma = hint.hops ? params_.sigma_odometry : params_.sigma_hops;
  const int radius =
      params_.hop_radius + static_cast<int>(std::min(std::ceil(centre), 1.0 * params_.hop_radius));
  std::vector<double> weight;
  for (int d = 0; d <= radius; ++d) weight.push_back(gaussian(d - centre, sigma) + 1e-12);
  HopSearch search(adjacency);
  const double least = nothing(adjacency.size(), from.size(), 0.0);
  for (std::size_t i = 0; i < adjacency.size(); ++i) {
    if (std::all_of(from.begin(), from.end(), [&](const auto& layer) { return layer[i] <= least; })) {
      for (std::size_t k = 0; k < from.size(); ++k) to[k][i] += from[k][i];
      continue;
    }
    const auto reached = search.within(static_cast<int>(i), radius);
    double total = 0;
    for (const auto& hop : reached) total += weight[static_cast<std::size_t>(hop.hops)];
    for (const auto& hop : reached) {
      const double share = weight[static_cast<std::size_t>(hop.hops)] / total;
      for (std::size_t k = 0; k < from.size(); ++k)
        to[k][static_cast<std::size_t>(hop.place)] += from[k][i] * share;
    }
  }
}

std::unique_ptr<MotionModel> makeMotionModel(const BeliefParams& params) {
  if (params.advance == "learned") return std::make_unique<ChainMotion>(params);
  if (params.advance == "odometry") return std::make_unique<OdometryMotion>(params);
  return std::make_unique<BlindMotion>(params);
}

}  // namespace engram::belief

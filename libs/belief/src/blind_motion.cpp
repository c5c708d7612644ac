// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion_models.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace engram::belief {

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

void Neighbourhoods::follow(const Adjacency& adjacency, int radius) {
  const std::size_t n = adjacency.size();
  if (radius > radius_ || n < neighbours_.size()) {
    neighbours_.clear();
    around_.clear();
    radius_ = std::max(radius, radius_);
  }
  HopSearch search(adjacency);
  std::vector<std::size_t> touched;
  const auto touch = [&](const auto& hops) {
    for (const Hop& hop : hops) touched.push_back(static_cast<std::size_t>(hop.place));
  };
  const std::size_t before = neighbours_.size();
  around_.resize(n);
  neighbours_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (i < before && neighbours_[i] == adjacency.neighbours[i]) continue;
    neighbours_[i] = adjacency.neighbours[i];
    touch(around_[i]);  // who saw it, and who sees it now
    touch(search.within(static_cast<int>(i), radius_));
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const std::size_t i : touched) {
    const auto hops = search.within(static_cast<int>(i), radius_);
    around_[i].assign(hops.begin(), hops.end());
  }
}

void BlindMotion::move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) {
  const double centre = hint.hops.value_or(params_.expected_hops);
  const double sigma = hint.hops ? params_.sigma_odometry : params_.sigma_hops;
  const int radius =
      params_.hop_radius + static_cast<int>(std::min(std::ceil(centre), 1.0 * params_.hop_radius));
  std::vector<double> weight;
  for (int d = 0; d <= radius; ++d) weight.push_back(gaussian(d - centre, sigma) + 1e-12);
  around_.follow(adjacency, radius);
  for (std::size_t i = 0; i < adjacency.size(); ++i) {
    if (std::all_of(from.begin(), from.end(), [i](const auto& layer) { return layer[i] <= 0; })) continue;
    std::span<const Hop> reached = around_.of(i);
    while (reached.back().hops > radius) reached = reached.first(reached.size() - 1);
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

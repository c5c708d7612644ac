// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion_models.h"

#include <algorithm>

namespace engram::belief {

void BlindMotion::move(const Adjacency& adjacency, const Layers& from, const MotionHint& hint, Layers& to) {
  const double centre = hint.hops.value_or(params_.expected_hops);
  const double sigma = hint.hops ? params_.sigma_odometry : params_.sigma_hops;
  const int radius =
      params_.hop_radius + static_cast<int>(std::min(std::ceil(centre), 1.0 * params_.hop_radius));
  std::vector<double> weight;
  for (int d = 0; d <= radius; ++d) weight.push_back(gaussian(d - centre, sigma) + 1e-12);
  HopSearch search(adjacency);
  for (std::size_t i = 0; i < adjacency.size(); ++i) {
    if (std::all_of(from.begin(), from.end(), [i](const auto& layer) { return layer[i] <= 0; })) continue;
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

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "two_means.h"

#include "descriptor_distance.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace engram::vocabulary {
namespace {

constexpr int kIterations = 6;

std::size_t farthest(const std::byte* from, const types::Descriptors& rows, std::vector<float>& distances) {
  distancesTo(from, rows, distances.data());
  return static_cast<std::size_t>(std::max_element(distances.begin(), distances.end()) - distances.begin());
}

/// Each row to the nearer mean; those that are hardest to tell make up for a side that is too small.
std::vector<std::uint8_t> toNearerMean(const types::Descriptors& rows, const types::Descriptors& means) {
  std::vector<float> margin(rows.size()), other(rows.size());
  distancesTo(means.row(0).data(), rows, margin.data());
  distancesTo(means.row(1).data(), rows, other.data());
  std::transform(margin.begin(), margin.end(), other.begin(), margin.begin(), std::minus<>());
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return margin[a] < margin[b]; });
  const auto nearFirst = std::count_if(margin.begin(), margin.end(), [](float m) { return m < 0; });
  const std::size_t least = rows.size() / 4;
  const auto cut = std::clamp(static_cast<std::size_t>(nearFirst), least, rows.size() - least);
  std::vector<std::uint8_t> side(rows.size(), 0);
  for (std::size_t k = cut; k < order.size(); ++k) side[order[k]] = 1;
  return side;
}

}  // namespace

TwoMeans twoMeans(const types::Descriptors& rows) {
  std::vector<float> distances(rows.size());
  TwoMeans result{{}, types::Descriptors(rows.kind(), rows.dim())};
  const std::size_t first = farthest(rows.row(0).data(), rows, distances);
  result.means.append(rows.row(first));
  result.means.append(rows.row(farthest(rows.row(first).data(), rows, distances)));
  for (int k = 0; k < kIterations; ++k) {
    auto side = toNearerMean(rows, result.means);
    const bool settled = side == result.side;
    result.side = std::move(side);
    if (settled) break;
    for (const std::uint8_t s : {0, 1}) meanOf(rows, result.side, s, result.means.mutableRow(s));
  }
  return result;
}

}  // namespace engram::vocabulary

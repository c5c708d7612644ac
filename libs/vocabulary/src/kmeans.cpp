// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kmeans.h"

#include "descriptor_distance.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace engram::vocabulary {
namespace {

using types::DescriptorKind;
using types::Descriptors;

/// The next centre is drawn with a chance that grows with the square of the distance to those there are.
Descriptors start(const Descriptors& rows, int k, base::Rng& rng) {
  Descriptors centres(rows.kind(), rows.dim());
  std::vector<float> distances(rows.size()), nearest(rows.size(), std::numeric_limits<float>::infinity());
  std::size_t chosen = rng.below(static_cast<std::uint32_t>(rows.size()));
  while (true) {
    centres.append(rows.row(chosen));
    if (static_cast<int>(centres.size()) == k) return centres;
    distancesTo(rows.row(chosen).data(), rows, distances.data());
    double sum = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // Numbers of bits are distances, not squares of them.
      const float squared =
          rows.kind() == DescriptorKind::kBinary ? distances[i] * distances[i] : distances[i];
      nearest[i] = std::min(nearest[i], squared);
      sum += nearest[i];
    }
    if (sum <= 0) return centres;
    double ticket = rng.uniform(0, sum);
    for (chosen = 0; chosen + 1 < rows.size() && ticket >= nearest[chosen]; ++chosen)
      ticket -= nearest[chosen];
    while (nearest[chosen] <= 0) --chosen;  // the sum was rounded
  }
}

std::vector<std::uint8_t> assign(const Descriptors& rows, const Descriptors& centres) {
  std::vector<std::uint8_t> nearest(rows.size());
  std::vector<float> distances(centres.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    distancesTo(rows.row(i).data(), centres, distances.data());
    nearest[i] =
        static_cast<std::uint8_t>(std::min_element(distances.begin(), distances.end()) - distances.begin());
  }
  return nearest;
}

/// Drops the centres that no row is nearest to.
void dropEmpty(Clustering& c) {
  std::vector<std::uint8_t> number(c.centres.size(), 0);
  for (const std::uint8_t n : c.nearest) number[n] = 1;
  Descriptors left(c.centres.kind(), c.centres.dim());
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (number[k] == 0) continue;
    number[k] = static_cast<std::uint8_t>(left.size());
    left.append(c.centres.row(k));
  }
  for (std::uint8_t& n : c.nearest) n = number[n];
  c.centres = std::move(left);
}

}  // namespace

Clustering kMeans(const Descriptors& rows, int k, int iterations, base::Rng rng) {
  Clustering result{start(rows, k, rng), {}};
  result.nearest = assign(rows, result.centres);
  for (int i = 0; i < iterations; ++i) {
    dropEmpty(result);
    for (std::size_t c = 0; c < result.centres.size(); ++c)
      meanOf(rows, result.nearest, static_cast<std::uint8_t>(c), result.centres.mutableRow(c));
    auto nearest = assign(rows, result.centres);
    const bool settled = nearest == result.nearest;
    result.nearest = std::move(nearest);
    if (settled) break;
  }
  dropEmpty(result);
  return result;
}

}  // namespace engram::vocabulary

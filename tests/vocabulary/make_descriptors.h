// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/types/features.h"

#include <cmath>
#include <span>
#include <vector>

namespace engram::vocabulary {

inline types::Descriptors floatDescriptors(const std::vector<std::vector<float>>& rows) {
  types::Descriptors d(types::DescriptorKind::kFloat, static_cast<int>(rows.front().size()));
  for (const auto& row : rows) d.append(std::as_bytes(std::span(row)));
  return d;
}

inline std::vector<float> randomUnit(int dim, base::Rng& rng) {
  std::vector<float> v(static_cast<std::size_t>(dim));
  double squares = 0;
  for (float& c : v) {
    c = static_cast<float>(rng.normal());
    squares += c * c;
  }
  for (float& c : v) c /= static_cast<float>(std::sqrt(squares));
  return v;
}

/// n unit vectors of uniform direction.
inline types::Descriptors randomFloats(int n, int dim, base::Rng& rng) {
  types::Descriptors d(types::DescriptorKind::kFloat, dim);
  for (int i = 0; i < n; ++i) d.append(std::as_bytes(std::span<const float>(randomUnit(dim, rng))));
  return d;
}

}  // namespace engram::vocabulary

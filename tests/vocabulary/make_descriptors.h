// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/types/features.h"

#include <gtest/gtest.h>

#include <bit>
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

/// n rows of random bits.
inline types::Descriptors randomBits(int n, int bits, base::Rng& rng) {
  types::Descriptors d(types::DescriptorKind::kBinary, bits);
  for (int i = 0; i < n; ++i) {
    std::vector<std::uint64_t> row(d.rowBytes() / 8);
    for (auto& word : row) word = rng.bits();
    if (bits % 64 != 0) row.back() &= (std::uint64_t{1} << (bits % 64)) - 1;
    d.append(std::as_bytes(std::span<const std::uint64_t>(row)));
  }
  return d;
}

inline types::Descriptors randomRows(types::DescriptorKind kind, int n, int dim, base::Rng& rng) {
  if (kind == types::DescriptorKind::kBinary) return randomBits(n, dim, rng);
  const auto d = randomFloats(n, dim, rng);
  return kind == types::DescriptorKind::kInt8 ? types::quantised(d) : d;
}

/// Row i of `d` as another image would show it: turned by about `sigma` (float), with that share of the bits
/// flipped (binary).
inline void appendSeenAgain(types::Descriptors& out, const types::Descriptors& d, std::size_t i, double sigma,
                            base::Rng& rng) {
  const auto dim = static_cast<std::size_t>(d.dim());
  if (d.kind() == types::DescriptorKind::kBinary) {
    std::vector<std::uint64_t> row(d.words(i), d.words(i) + d.rowBytes() / 8);
    for (std::size_t b = 0; b < dim; ++b)
      if (rng.uniform() < sigma) row[b / 64] ^= std::uint64_t{1} << (b % 64);
    out.append(std::as_bytes(std::span<const std::uint64_t>(row)));
    return;
  }
  types::Descriptors one(types::DescriptorKind::kFloat, d.dim());
  std::vector<float> row(dim);
  double squares = 0;
  for (std::size_t c = 0; c < dim; ++c) {
    row[c] = d.kind() == types::DescriptorKind::kFloat ? d.floats(i)[c]
                                                       : static_cast<float>(d.int8(i)[c]) / types::kInt8Scale;
    row[c] += static_cast<float>(rng.normal(0, sigma / std::sqrt(static_cast<double>(dim))));
    squares += row[c] * row[c];
  }
  for (float& c : row) c /= static_cast<float>(std::sqrt(squares));
  one.append(std::as_bytes(std::span<const float>(row)));
  out.append((out.kind() == types::DescriptorKind::kInt8 ? types::quantised(one) : one).row(0));
}

/// Their distance as types::Match::distance, written without a look at the library.
inline double distanceOf(const types::Descriptors& a, std::size_t i, const types::Descriptors& b,
                         std::size_t j) {
  if (a.kind() == types::DescriptorKind::kBinary) {
    int bits = 0;
    for (std::size_t w = 0; w < a.rowBytes() / 8; ++w) bits += std::popcount(a.words(i)[w] ^ b.words(j)[w]);
    return static_cast<double>(bits) / a.dim();
  }
  double sum = 0;
  for (int c = 0; c < a.dim(); ++c) {
    const double difference = a.kind() == types::DescriptorKind::kFloat
                                  ? static_cast<double>(a.floats(i)[c]) - static_cast<double>(b.floats(j)[c])
                                  : (a.int8(i)[c] - b.int8(j)[c]) / 254.0;
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

/// Name of a test that is made for each kind of descriptor.
inline std::string kindName(const testing::TestParamInfo<types::DescriptorKind>& test) {
  const char* names[] = {"Float", "Int8", "Binary"};
  return names[static_cast<std::size_t>(test.param)];
}

}  // namespace engram::vocabulary

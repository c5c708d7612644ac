// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "near_duplicates.h"

#include <algorithm>
#include <bit>

namespace engram::memory {
namespace {

using types::DescriptorKind;
using types::Descriptors;

/// True when the squared L2 distance is below `limit`. Most rows fail in the first block of components.
template <class Component, class Sum>
bool closer(const Component* a, const Component* b, int dim, Sum limit) {
  constexpr int kBlock = 32;
  Sum sum = 0;
  for (int begin = 0; begin < dim; begin += kBlock) {
    const int end = std::min(begin + kBlock, dim);
    for (int d = begin; d < end; ++d) {
      const Sum difference = static_cast<Sum>(a[d]) - static_cast<Sum>(b[d]);
      sum += difference * difference;
    }
    if (sum >= limit) return false;
  }
  return true;
}

bool closerBits(const std::uint64_t* a, const std::uint64_t* b, std::size_t words, double limit) {
  int bits = 0;
  for (std::size_t w = 0; w < words; ++w) bits += std::popcount(a[w] ^ b[w]);
  return bits < limit;
}

}  // namespace

bool hasNearDuplicate(const Descriptors& set, const Descriptors& of, std::size_t i, double distance) {
  if (distance <= 0) return false;
  const std::size_t n = set.size();
  for (std::size_t j = 0; j < n; ++j) {
    bool near = false;
    switch (set.kind()) {
      case DescriptorKind::kFloat:
        near = closer(set.floats(j), of.floats(i), set.dim(), static_cast<float>(distance * distance));
        break;
      case DescriptorKind::kInt8: {
        const double scaled = distance * types::kInt8Scale;
        near =
            closer<std::int8_t, int>(set.int8(j), of.int8(i), set.dim(), static_cast<int>(scaled * scaled));
        break;
      }
      case DescriptorKind::kBinary:
        near = closerBits(set.words(j), of.words(i), set.rowBytes() / 8, distance * set.dim());
        break;
    }
    if (near) return true;
  }
  return false;
}

}  // namespace engram::memory

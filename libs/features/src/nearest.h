// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cpu.h"
#include "descriptor_blocks.h"

#include <limits>
#include <vector>

namespace engram::features {

/// The nearest and second nearest of a group. Distances are squared (kFloat, kInt8) or numbers of bits
/// (kBinary), all exact where they are integers.
struct Nearest {
  int row = -1;  ///< of the group; ties: the lower. -1 in an empty group
  float first = std::numeric_limits<float>::infinity();
  float second = std::numeric_limits<float>::infinity();
};

/// For rows begin … end-1 of `queries` the nearest of `group`; both of `kind` and equal dimension. `out` has
/// room for end - begin results. All levels give the same bits.
void findNearest(SimdLevel level, types::DescriptorKind kind, const DescriptorGroup& queries, int begin,
                 int end, const DescriptorGroup& group, Nearest* out);

namespace detail {

/// A kernel: as findNearest, for one kind, on a group of at least one row.
using NearestKernel = void (*)(const DescriptorGroup& queries, int begin, int end,
                               const DescriptorGroup& group, Nearest* out);

void nearestFloatPortable(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
void nearestInt8Portable(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
void nearestBinaryPortable(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
#if defined(__x86_64__)
void nearestFloatAvx2(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
void nearestInt8Avx2(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
void nearestBinaryAvx2(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
void nearestInt8Vnni(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
void nearestBinaryAvx512(const DescriptorGroup&, int, int, const DescriptorGroup&, Nearest*);
#endif

/// Joins the running minima of the lanes; `block[l]` is the block where lane l found its minimum.
inline Nearest joinLanes(const float* first, const float* second, const int* block) {
  Nearest best;
  int bestLane = 0;
  for (int l = 0; l < kLanes; ++l) {
    const int row = block[l] * kLanes + l;
    if (first[l] < best.first || (first[l] == best.first && row < best.row)) {
      best.first = first[l];
      best.row = row;
      bestLane = l;
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    const float rest = l == bestLane ? second[l] : first[l];
    if (rest < best.second) best.second = rest;
  }
  return best;
}

}  // namespace detail
}  // namespace engram::features

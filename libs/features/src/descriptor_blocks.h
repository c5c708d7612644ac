// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::features {

inline constexpr int kLanes = 16;  ///< rows of one block

/// A set of descriptors in two layouts, for either side of a comparison.
///
/// `rows`: row after row, padded to whole units; the query side.
/// `blocks`: kLanes rows side by side, unit by unit (unit u of rows 0 … 15, then unit u + 1, …), so that a
/// kernel compares one query with kLanes rows without ever adding up across a register. A unit is a float,
/// four int8 or a word of 64 bits. Lanes beyond the last row hold zeros and lose by their bias.
///
/// kInt8 blocks hold b + 128 as unsigned bytes, because the VNNI and 16-bit multiplications want one unsigned
/// operand: |a - b|² = (|a|² + 256 sum(a)) + |b|² - 2 a·(b + 128); the bracket is `rowBias`, |b|² is
/// `laneBias`. All exact.
struct DescriptorGroup {
  struct alignas(64) Line {
    std::array<std::byte, 64> bytes;
  };

  int count = 0;
  int units = 0;  ///< per row
  std::size_t rowBytes = 0;
  std::size_t blockLines = 0;  ///< lines of one block
  std::vector<Line> rows;      ///< count * rowBytes bytes used
  std::vector<Line> blocks;
  std::vector<std::int32_t> rowBias;   ///< kInt8 only
  std::vector<std::int32_t> laneBias;  ///< kInt8, kBinary: one for each lane of each block
  std::vector<float> floatLaneBias;    ///< kFloat
  std::vector<int> index;              ///< of each row in the original set, ascending

  int blockCount() const { return (count + kLanes - 1) / kLanes; }
  const std::byte* row(int i) const {
    return reinterpret_cast<const std::byte*>(rows.data()) + static_cast<std::size_t>(i) * rowBytes;
  }
};

/// A feature set ready for the kernels, split by the sign of the Laplacian when all features carry one.
struct PreparedSet {
  types::DescriptorKind kind = types::DescriptorKind::kFloat;
  int dim = 0;
  std::size_t size = 0;
  bool isSigned = false;
  std::array<DescriptorGroup, 2> groups;  ///< negative, positive; without signs all are in the first

  PreparedSet() = default;
  explicit PreparedSet(const types::Features& features);
};

}  // namespace engram::features

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "descriptor_blocks.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace engram::features {
namespace {

using types::DescriptorKind;

// Larger than any sum of squares of 256 components, and exact as a float.
constexpr std::int32_t kNeverNearest = 1 << 30;

std::size_t unitBytes(DescriptorKind kind) { return kind == DescriptorKind::kBinary ? 8 : 4; }

std::size_t linesFor(std::size_t bytes) {
  return (bytes + sizeof(DescriptorGroup::Line) - 1) / sizeof(DescriptorGroup::Line);
}

void fillRows(DescriptorGroup& g, const types::Descriptors& d) {
  g.rows.assign(linesFor(static_cast<std::size_t>(g.count) * g.rowBytes), {});
  auto* out = reinterpret_cast<std::byte*>(g.rows.data());
  for (const int i : g.index) {
    const auto row = d.row(static_cast<std::size_t>(i));
    std::memcpy(out, row.data(), row.size());
    out += g.rowBytes;
  }
}

void fillBlocks(DescriptorGroup& g, DescriptorKind kind) {
  const std::size_t unit = unitBytes(kind);
  g.blockLines = static_cast<std::size_t>(g.units) * kLanes * unit / sizeof(DescriptorGroup::Line);
  g.blocks.assign(g.blockLines * static_cast<std::size_t>(g.blockCount()), {});
  auto* base = reinterpret_cast<std::byte*>(g.blocks.data());
  for (int i = 0; i < g.count; ++i) {
    std::byte* out = base +
                     static_cast<std::size_t>(i / kLanes) * g.blockLines * sizeof(DescriptorGroup::Line) +
                     static_cast<std::size_t>(i % kLanes) * unit;
    for (int u = 0; u < g.units; ++u, out += kLanes * unit)
      std::memcpy(out, g.row(i) + static_cast<std::size_t>(u) * unit, unit);
  }
  if (kind != DescriptorKind::kInt8) return;
  for (auto& line : g.blocks)
    for (auto& b : line.bytes) b ^= std::byte{0x80};  // signed b to unsigned b + 128
}

void fillBias(DescriptorGroup& g, DescriptorKind kind) {
  const auto lanes = static_cast<std::size_t>(g.blockCount() * kLanes);
  if (kind == DescriptorKind::kFloat) {
    g.floatLaneBias.assign(lanes, std::numeric_limits<float>::infinity());
    std::fill_n(g.floatLaneBias.begin(), g.count, 0.0f);
    return;
  }
  g.laneBias.assign(lanes, kNeverNearest);
  std::fill_n(g.laneBias.begin(), g.count, 0);
  if (kind == DescriptorKind::kBinary) return;
  g.rowBias.resize(static_cast<std::size_t>(g.count));
  for (int i = 0; i < g.count; ++i) {
    const auto* row = reinterpret_cast<const std::int8_t*>(g.row(i));
    std::int32_t squares = 0, sum = 0;
    for (std::size_t c = 0; c < g.rowBytes; ++c) {
      squares += row[c] * row[c];
      sum += row[c];
    }
    g.laneBias[static_cast<std::size_t>(i)] = squares;
    g.rowBias[static_cast<std::size_t>(i)] = squares + 256 * sum;
  }
}

}  // namespace

PreparedSet::PreparedSet(const types::Features& features)
    : kind(features.descriptors.kind()), dim(features.descriptors.dim()), size(features.size()) {
  const auto& keypoints = features.keypoints;
  isSigned = !keypoints.empty() &&
             std::all_of(keypoints.begin(), keypoints.end(), [](auto& k) { return k.sign != 0; });
  for (std::size_t i = 0; i < size; ++i)
    groups[isSigned && keypoints[i].sign > 0].index.push_back(static_cast<int>(i));
  for (auto& g : groups) {
    g.count = static_cast<int>(g.index.size());
    const std::size_t unit = unitBytes(kind);
    g.units = static_cast<int>((features.descriptors.rowBytes() + unit - 1) / unit);
    g.rowBytes = static_cast<std::size_t>(g.units) * unit;
    fillRows(g, features.descriptors);
    fillBlocks(g, kind);
    fillBias(g, kind);
  }
}

}  // namespace engram::features

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "nearest.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace engram::features {
namespace detail {
namespace {

/// The running minima of kLanes lanes.
struct Lanes {
  float first[kLanes], second[kLanes];
  int block[kLanes];

  Lanes() {
    std::fill_n(first, kLanes, std::numeric_limits<float>::infinity());
    std::fill_n(second, kLanes, std::numeric_limits<float>::infinity());
    std::fill_n(block, kLanes, 0);
  }
  void add(const float* distance, int b) {
    for (int l = 0; l < kLanes; ++l) {
      const bool nearer = distance[l] < first[l];
      const float larger = nearer ? first[l] : distance[l];
      second[l] = larger < second[l] ? larger : second[l];
      first[l] = nearer ? distance[l] : first[l];
      block[l] = nearer ? b : block[l];
    }
  }
  Nearest join() const { return joinLanes(first, second, block); }
};

template <class T>
const T* blockData(const DescriptorGroup& g, int b) {
  return reinterpret_cast<const T*>(g.blocks.data() + static_cast<std::size_t>(b) * g.blockLines);
}

/// `distances(query, block, out)` writes kLanes distances.
template <class Distances>
void scan(int begin, int end, const DescriptorGroup& group, Nearest* out, const Distances& distances) {
  for (int q = begin; q < end; ++q) {
    Lanes lanes;
    float d[kLanes];
    for (int b = 0; b < group.blockCount(); ++b) {
      distances(q, b, d);
      lanes.add(d, b);
    }
    *out++ = lanes.join();
  }
}

}  // namespace

void nearestFloatPortable(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                          Nearest* out) {
  scan(begin, end, group, out, [&](int q, int b, float* d) {
    const auto* query = reinterpret_cast<const float*>(queries.row(q));
    const auto* block = blockData<float>(group, b);
    std::copy_n(group.floatLaneBias.data() + b * kLanes, kLanes, d);
    for (int u = 0; u < group.units; ++u)
      for (int l = 0; l < kLanes; ++l) {
        const float difference = query[u] - block[u * kLanes + l];
        d[l] += difference * difference;
      }
  });
}

void nearestInt8Portable(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                         Nearest* out) {
  scan(begin, end, group, out, [&](int q, int b, float* d) {
    const auto* query = reinterpret_cast<const std::int8_t*>(queries.row(q));
    const auto* block = blockData<std::uint8_t>(group, b);
    std::int32_t dot[kLanes] = {};
    for (int u = 0; u < group.units; ++u)
      for (int l = 0; l < kLanes; ++l)
        for (int c = 0; c < 4; ++c) dot[l] += query[4 * u + c] * block[(u * kLanes + l) * 4 + c];
    const std::int32_t rowBias = queries.rowBias[static_cast<std::size_t>(q)];
    for (int l = 0; l < kLanes; ++l)
      d[l] =
          static_cast<float>(rowBias + group.laneBias[static_cast<std::size_t>(b * kLanes + l)] - 2 * dot[l]);
  });
}

void nearestBinaryPortable(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                           Nearest* out) {
  scan(begin, end, group, out, [&](int q, int b, float* d) {
    const auto* query = reinterpret_cast<const std::uint64_t*>(queries.row(q));
    const auto* block = blockData<std::uint64_t>(group, b);
    std::int32_t bits[kLanes];
    std::copy_n(group.laneBias.data() + b * kLanes, kLanes, bits);
    for (int u = 0; u < group.units; ++u)
      for (int l = 0; l < kLanes; ++l) bits[l] += std::popcount(query[u] ^ block[u * kLanes + l]);
    for (int l = 0; l < kLanes; ++l) d[l] = static_cast<float>(bits[l]);
  });
}

namespace {

NearestKernel kernelFor(SimdLevel level, types::DescriptorKind kind) {
  using types::DescriptorKind;
#if defined(__x86_64__)
  // A processor may have one of the two AVX-512 extensions only.
  if (level == SimdLevel::kAvx512 && kind == DescriptorKind::kInt8 && __builtin_cpu_supports("avx512vnni"))
    return nearestInt8Vnni;
  if (level == SimdLevel::kAvx512 && kind == DescriptorKind::kBinary &&
      __builtin_cpu_supports("avx512vpopcntdq"))
    return nearestBinaryAvx512;
  if (level >= SimdLevel::kAvx2) {
    switch (kind) {
      case DescriptorKind::kFloat:
        return nearestFloatAvx2;
      case DescriptorKind::kInt8:
        return nearestInt8Avx2;
      case DescriptorKind::kBinary:
        return nearestBinaryAvx2;
    }
  }
#endif
  static_cast<void>(level);
  switch (kind) {
    case DescriptorKind::kFloat:
      return nearestFloatPortable;
    case DescriptorKind::kInt8:
      return nearestInt8Portable;
    case DescriptorKind::kBinary:
      return nearestBinaryPortable;
  }
  return nullptr;
}

}  // namespace
}  // namespace detail

void findNearest(SimdLevel level, types::DescriptorKind kind, const DescriptorGroup& queries, int begin,
                 int end, const DescriptorGroup& group, Nearest* out) {
  if (group.count == 0) {
    std::fill_n(out, end - begin, Nearest{});
    return;
  }
  detail::kernelFor(level, kind)(queries, begin, end, group, out);
  if (group.count > 1) return;
  for (Nearest* n = out; n != out + (end - begin); ++n) n->second = std::numeric_limits<float>::infinity();
}

}  // namespace engram::features

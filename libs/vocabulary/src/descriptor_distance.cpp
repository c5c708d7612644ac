// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "descriptor_distance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

// The loops below are compiled twice, for the processor that every build must run on and for AVX2. The latter
// has no fused multiplication, so that floats come out the same.
#if defined(__x86_64__)
#define ENGRAM_AVX2 __attribute__((target("avx2,popcnt")))
#endif

namespace engram::vocabulary {
namespace {

using types::DescriptorKind;
using types::Descriptors;

#define ENGRAM_INLINE __attribute__((always_inline)) inline

ENGRAM_INLINE void int8Distances(const std::int8_t* query, const std::int8_t* row, std::size_t n,
                                 std::size_t dim, float* out) {
  for (std::size_t i = 0; i < n; ++i, row += dim) {
    std::int32_t sum = 0;
    for (std::size_t c = 0; c < dim; ++c) {
      const auto difference = static_cast<std::int16_t>(query[c] - row[c]);
      sum += difference * difference;
    }
    out[i] = static_cast<float>(sum);
  }
}

ENGRAM_INLINE void floatDistances(const float* query, const float* row, std::size_t n, std::size_t dim,
                                  float* out) {
  constexpr std::size_t kLanes = 8;
  for (std::size_t i = 0; i < n; ++i, row += dim) {
    float sums[kLanes] = {};  // fixes the order of summation
    std::size_t c = 0;
    for (; c + kLanes <= dim; c += kLanes)
      for (std::size_t l = 0; l < kLanes; ++l) {
        const float difference = query[c + l] - row[c + l];
        sums[l] += difference * difference;
      }
    for (; c < dim; ++c) sums[0] += (query[c] - row[c]) * (query[c] - row[c]);
    out[i] = ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
  }
}

ENGRAM_INLINE void binaryDistances(const std::uint64_t* query, const std::uint64_t* row, std::size_t n,
                                   std::size_t words, float* out) {
  for (std::size_t i = 0; i < n; ++i, row += words) {
    int bits = 0;
    for (std::size_t w = 0; w < words; ++w) bits += std::popcount(query[w] ^ row[w]);
    out[i] = static_cast<float>(bits);
  }
}

ENGRAM_INLINE void distances(const std::byte* query, const Descriptors& rows, std::size_t first,
                             std::size_t n, float* out) {
  if (n == 0) return;
  const auto dim = static_cast<std::size_t>(rows.dim());
  switch (rows.kind()) {
    case DescriptorKind::kInt8:
      return int8Distances(reinterpret_cast<const std::int8_t*>(query), rows.int8(first), n, dim, out);
    case DescriptorKind::kFloat:
      return floatDistances(reinterpret_cast<const float*>(query), rows.floats(first), n, dim, out);
    case DescriptorKind::kBinary:
      return binaryDistances(reinterpret_cast<const std::uint64_t*>(query), rows.words(first), n,
                             rows.rowBytes() / 8, out);
  }
}

#if defined(__x86_64__)
ENGRAM_AVX2 void distancesAvx2(const std::byte* query, const Descriptors& rows, std::size_t first,
                               std::size_t n, float* out) {
  distances(query, rows, first, n, out);
}
#endif

void distancesPortable(const std::byte* query, const Descriptors& rows, std::size_t first, std::size_t n,
                       float* out) {
  distances(query, rows, first, n, out);
}

/// Adds up component c of the chosen rows by `get(row, c)`.
template <class T, class Get>
std::vector<T> sums(const Descriptors& rows, const std::vector<std::uint8_t>& chosen, std::uint8_t flag,
                    Get&& get) {
  std::vector<T> sum(static_cast<std::size_t>(rows.dim()), T{0});
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (chosen[i] == flag)
      for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += get(i, c);
  return sum;
}

/// How often each bit is set in the chosen rows. Eight bits at a time are spread over the bytes of a word,
/// which hold the sums of up to 255 rows.
std::vector<int> bitSums(const Descriptors& rows, const std::vector<std::uint8_t>& chosen,
                         std::uint8_t flag) {
  static const auto kSpread = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::size_t b = 0; b < table.size(); ++b)
      for (std::size_t bit = 0; bit < 8; ++bit) table[b] |= (std::uint64_t{b} >> bit & 1) << (8 * bit);
    return table;
  }();
  std::vector<std::uint64_t> partial(rows.rowBytes(), 0);
  std::vector<int> sum(8 * partial.size(), 0);
  const auto flush = [&] {
    for (std::size_t c = 0; c < sum.size(); ++c)
      sum[c] += static_cast<int>(partial[c / 8] >> (8 * (c % 8)) & 0xff);
    std::fill(partial.begin(), partial.end(), 0);
  };
  int pending = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (chosen[i] != flag) continue;
    const auto row = rows.row(i);
    for (std::size_t b = 0; b < row.size(); ++b) partial[b] += kSpread[std::to_integer<std::size_t>(row[b])];
    if (++pending < 255) continue;
    flush();
    pending = 0;
  }
  flush();
  return sum;
}

}  // namespace

void distancesTo(const std::byte* query, const Descriptors& rows, float* out) {
  distancesTo(query, rows, 0, rows.size(), out);
}

void distancesTo(const std::byte* query, const Descriptors& rows, std::size_t first, std::size_t n,
                 float* out) {
#if defined(__x86_64__)
  static const bool hasAvx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
  if (hasAvx2) return distancesAvx2(query, rows, first, n, out);
#endif
  distancesPortable(query, rows, first, n, out);
}

void meanOf(const Descriptors& rows, const std::vector<std::uint8_t>& chosen, std::uint8_t flag,
            std::byte* out) {
  const auto n = std::count(chosen.begin(), chosen.end(), flag);
  std::memset(out, 0, rows.rowBytes());
  switch (rows.kind()) {
    case DescriptorKind::kFloat: {
      const auto sum = sums<double>(rows, chosen, flag, [&](auto i, auto c) { return rows.floats(i)[c]; });
      for (std::size_t c = 0; c < sum.size(); ++c)
        reinterpret_cast<float*>(out)[c] = static_cast<float>(sum[c] / static_cast<double>(n));
      return;
    }
    case DescriptorKind::kInt8: {
      const auto sum = sums<int>(rows, chosen, flag, [&](auto i, auto c) { return rows.int8(i)[c]; });
      for (std::size_t c = 0; c < sum.size(); ++c)
        reinterpret_cast<std::int8_t*>(out)[c] =
            static_cast<std::int8_t>(std::lround(static_cast<double>(sum[c]) / static_cast<double>(n)));
      return;
    }
    case DescriptorKind::kBinary: {
      const auto sum = bitSums(rows, chosen, flag);
      for (std::size_t c = 0; c < sum.size(); ++c)
        if (2 * sum[c] > n) reinterpret_cast<std::uint64_t*>(out)[c / 64] |= std::uint64_t{1} << (c % 64);
      return;
    }
  }
}

}  // namespace engram::vocabulary

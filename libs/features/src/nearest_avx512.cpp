// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "nearest.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define ENGRAM_AVX512_INLINE __attribute__((target("avx512f"), always_inline)) inline
#define ENGRAM_VNNI __attribute__((target("avx512f,avx512vnni")))
#define ENGRAM_POPCNT __attribute__((target("avx512f,avx512vpopcntdq")))

namespace engram::features::detail {
namespace {

constexpr int kQueriesAtOnce = 8;  // accumulators that hide the latency of a multiplication

/// Running minima of one query against 16 lanes.
struct Minima {
  __m512 first, second;
  __m512i block;
};

ENGRAM_AVX512_INLINE void reset(Minima& m) {
  m.first = m.second = _mm512_set1_ps(std::numeric_limits<float>::infinity());
  m.block = _mm512_setzero_si512();
}

ENGRAM_AVX512_INLINE void update(Minima& m, __m512i distance, int block) {
  const __m512 d = _mm512_cvtepi32_ps(distance);
  const __mmask16 nearer = _mm512_cmp_ps_mask(d, m.first, _CMP_LT_OQ);
  m.second = _mm512_min_ps(m.second, _mm512_max_ps(m.first, d));
  m.first = _mm512_min_ps(m.first, d);
  m.block = _mm512_mask_mov_epi32(m.block, nearer, _mm512_set1_epi32(block));
}

ENGRAM_AVX512_INLINE Nearest join(const Minima& m) {
  const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m512i row = _mm512_add_epi32(_mm512_slli_epi32(m.block, 4), lane);
  Nearest n;
  n.first = _mm512_reduce_min_ps(m.first);
  const __mmask16 best = _mm512_cmp_ps_mask(m.first, _mm512_set1_ps(n.first), _CMP_EQ_OQ);
  n.row = _mm512_mask_reduce_min_epi32(best, row);
  const __mmask16 chosen = _mm512_cmpeq_epi32_mask(row, _mm512_set1_epi32(n.row));
  n.second = _mm512_reduce_min_ps(_mm512_mask_mov_ps(m.first, chosen, m.second));
  return n;
}

template <int Q>
ENGRAM_VNNI void scanInt8(const DescriptorGroup& queries, int begin, const DescriptorGroup& group,
                          Nearest* out) {
  const std::int32_t* query[Q];
  Minima minima[Q];
  for (int q = 0; q < Q; ++q) {
    query[q] = reinterpret_cast<const std::int32_t*>(queries.row(begin + q));
    reset(minima[q]);
  }
  const auto* block = reinterpret_cast<const __m512i*>(group.blocks.data());
  for (int b = 0; b < group.blockCount(); ++b) {
    __m512i dot[Q];
    for (int q = 0; q < Q; ++q) dot[q] = _mm512_setzero_si512();
    for (int u = 0; u < group.units; ++u, ++block) {
      const __m512i bytes = _mm512_load_si512(block);
      for (int q = 0; q < Q; ++q) dot[q] = _mm512_dpbusd_epi32(dot[q], bytes, _mm512_set1_epi32(query[q][u]));
    }
    const __m512i laneBias = _mm512_loadu_si512(group.laneBias.data() + b * kLanes);
    for (int q = 0; q < Q; ++q) {
      const __m512i rowBias = _mm512_set1_epi32(queries.rowBias[static_cast<std::size_t>(begin + q)]);
      update(minima[q], _mm512_sub_epi32(_mm512_add_epi32(rowBias, laneBias), _mm512_slli_epi32(dot[q], 1)),
             b);
    }
  }
  for (int q = 0; q < Q; ++q) out[q] = join(minima[q]);
}

template <int Q>
ENGRAM_POPCNT void scanBinary(const DescriptorGroup& queries, int begin, const DescriptorGroup& group,
                              Nearest* out) {
  const std::uint64_t* query[Q];
  Minima minima[Q];
  for (int q = 0; q < Q; ++q) {
    query[q] = reinterpret_cast<const std::uint64_t*>(queries.row(begin + q));
    reset(minima[q]);
  }
  const auto* block = reinterpret_cast<const __m512i*>(group.blocks.data());
  for (int b = 0; b < group.blockCount(); ++b) {
    __m512i bits[Q][2];
    for (int q = 0; q < Q; ++q) bits[q][0] = bits[q][1] = _mm512_setzero_si512();
    for (int u = 0; u < group.units; ++u, block += 2) {
      const __m512i low = _mm512_load_si512(block), high = _mm512_load_si512(block + 1);
      for (int q = 0; q < Q; ++q) {
        const __m512i value = _mm512_set1_epi64(static_cast<long long>(query[q][u]));
        bits[q][0] = _mm512_add_epi64(bits[q][0], _mm512_popcnt_epi64(_mm512_xor_si512(value, low)));
        bits[q][1] = _mm512_add_epi64(bits[q][1], _mm512_popcnt_epi64(_mm512_xor_si512(value, high)));
      }
    }
    const __m512i laneBias = _mm512_loadu_si512(group.laneBias.data() + b * kLanes);
    for (int q = 0; q < Q; ++q) {
      const __m512i low = _mm512_castsi256_si512(_mm512_cvtepi64_epi32(bits[q][0]));
      const __m512i all = _mm512_inserti64x4(low, _mm512_cvtepi64_epi32(bits[q][1]), 1);
      update(minima[q], _mm512_add_epi32(all, laneBias), b);
    }
  }
  for (int q = 0; q < Q; ++q) out[q] = join(minima[q]);
}

}  // namespace

void nearestInt8Vnni(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                     Nearest* out) {
  int q = begin;
  for (; q + kQueriesAtOnce <= end; q += kQueriesAtOnce)
    scanInt8<kQueriesAtOnce>(queries, q, group, out + (q - begin));
  for (; q < end; ++q) scanInt8<1>(queries, q, group, out + (q - begin));
}

void nearestBinaryAvx512(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                         Nearest* out) {
  int q = begin;
  for (; q + kQueriesAtOnce <= end; q += kQueriesAtOnce)
    scanBinary<kQueriesAtOnce>(queries, q, group, out + (q - begin));
  for (; q < end; ++q) scanBinary<1>(queries, q, group, out + (q - begin));
}

}  // namespace engram::features::detail
#endif

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// AVX2 without FMA: a fused multiply-add rounds once where the portable kernel rounds twice, and results must
// not depend on the machine.
#include "nearest.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define ENGRAM_AVX2 __attribute__((target("avx2")))
#define ENGRAM_AVX2_INLINE __attribute__((target("avx2"), always_inline)) inline

namespace engram::features::detail {
namespace {

/// Running minima of one query against 16 lanes in two registers.
struct Minima {
  __m256 first[2], second[2];
  __m256i block[2];
};

ENGRAM_AVX2_INLINE void reset(Minima& m) {
  for (int h = 0; h < 2; ++h) {
    m.first[h] = m.second[h] = _mm256_set1_ps(std::numeric_limits<float>::infinity());
    m.block[h] = _mm256_setzero_si256();
  }
}

ENGRAM_AVX2_INLINE void update(Minima& m, int half, __m256 distance, __m256i block) {
  const __m256 nearer = _mm256_cmp_ps(distance, m.first[half], _CMP_LT_OQ);
  m.second[half] = _mm256_min_ps(m.second[half], _mm256_max_ps(m.first[half], distance));
  m.first[half] = _mm256_min_ps(m.first[half], distance);
  m.block[half] = _mm256_blendv_epi8(m.block[half], block, _mm256_castps_si256(nearer));
}

ENGRAM_AVX2_INLINE Nearest join(const Minima& m) {
  alignas(32) float first[kLanes], second[kLanes];
  alignas(32) int block[kLanes];
  for (int h = 0; h < 2; ++h) {
    _mm256_store_ps(first + 8 * h, m.first[h]);
    _mm256_store_ps(second + 8 * h, m.second[h]);
    _mm256_store_si256(reinterpret_cast<__m256i*>(block + 8 * h), m.block[h]);
  }
  return joinLanes(first, second, block);
}

ENGRAM_AVX2_INLINE __m256i loadHalf(const void* p, int half) {
  return _mm256_load_si256(static_cast<const __m256i*>(p) + half);
}

/// Q queries at a time share the loads of the block.
template <int Q>
ENGRAM_AVX2 void scanFloat(const DescriptorGroup& queries, int begin, const DescriptorGroup& group,
                           Nearest* out) {
  const float* query[Q];
  Minima minima[Q];
  for (int q = 0; q < Q; ++q) {
    query[q] = reinterpret_cast<const float*>(queries.row(begin + q));
    reset(minima[q]);
  }
  const auto* block = reinterpret_cast<const float*>(group.blocks.data());
  for (int b = 0; b < group.blockCount(); ++b) {
    __m256 sum[Q][2];
    for (int q = 0; q < Q; ++q)
      for (int h = 0; h < 2; ++h)
        sum[q][h] = _mm256_loadu_ps(group.floatLaneBias.data() + b * kLanes + 8 * h);
    for (int u = 0; u < group.units; ++u, block += kLanes) {
      const __m256 low = _mm256_load_ps(block), high = _mm256_load_ps(block + 8);
      for (int q = 0; q < Q; ++q) {
        const __m256 value = _mm256_broadcast_ss(query[q] + u);
        const __m256 d0 = _mm256_sub_ps(value, low), d1 = _mm256_sub_ps(value, high);
        sum[q][0] = _mm256_add_ps(sum[q][0], _mm256_mul_ps(d0, d0));
        sum[q][1] = _mm256_add_ps(sum[q][1], _mm256_mul_ps(d1, d1));
      }
    }
    for (int q = 0; q < Q; ++q)
      for (int h = 0; h < 2; ++h) update(minima[q], h, sum[q][h], _mm256_set1_epi32(b));
  }
  for (int q = 0; q < Q; ++q) out[q] = join(minima[q]);
}

/// Products of 16-bit halves: bytes 0 and 2 of each unit, then bytes 1 and 3. No sum saturates.
template <int Q>
ENGRAM_AVX2 void scanInt8(const DescriptorGroup& queries, int begin, const DescriptorGroup& group,
                          Nearest* out) {
  const std::int32_t* query[Q];
  Minima minima[Q];
  for (int q = 0; q < Q; ++q) {
    query[q] = reinterpret_cast<const std::int32_t*>(queries.row(begin + q));
    reset(minima[q]);
  }
  const __m256i evenBytes = _mm256_set1_epi16(0x00ff);
  const auto* block = reinterpret_cast<const __m256i*>(group.blocks.data());
  for (int b = 0; b < group.blockCount(); ++b) {
    __m256i dot[Q][2];
    for (int q = 0; q < Q; ++q) dot[q][0] = dot[q][1] = _mm256_setzero_si256();
    for (int u = 0; u < group.units; ++u, block += 2) {
      for (int h = 0; h < 2; ++h) {
        const __m256i bytes = _mm256_load_si256(block + h);
        const __m256i even = _mm256_and_si256(bytes, evenBytes), odd = _mm256_srli_epi16(bytes, 8);
        for (int q = 0; q < Q; ++q) {
          const __m256i value = _mm256_set1_epi32(query[q][u]);
          const __m256i valueEven = _mm256_srai_epi16(_mm256_slli_epi16(value, 8), 8);
          const __m256i valueOdd = _mm256_srai_epi16(value, 8);
          const __m256i products =
              _mm256_add_epi32(_mm256_madd_epi16(even, valueEven), _mm256_madd_epi16(odd, valueOdd));
          dot[q][h] = _mm256_add_epi32(dot[q][h], products);
        }
      }
    }
    for (int q = 0; q < Q; ++q) {
      const __m256i rowBias = _mm256_set1_epi32(queries.rowBias[static_cast<std::size_t>(begin + q)]);
      for (int h = 0; h < 2; ++h) {
        const auto* bias = reinterpret_cast<const __m256i*>(group.laneBias.data() + b * kLanes + 8 * h);
        const __m256i biases = _mm256_add_epi32(rowBias, _mm256_loadu_si256(bias));
        const __m256i d = _mm256_sub_epi32(biases, _mm256_slli_epi32(dot[q][h], 1));
        update(minima[q], h, _mm256_cvtepi32_ps(d), _mm256_set1_epi32(b));
      }
    }
  }
  for (int q = 0; q < Q; ++q) out[q] = join(minima[q]);
}

/// Number of set bits of each byte, by two table look-ups (Muła, Kurz & Lemire 2018).
ENGRAM_AVX2_INLINE __m256i bitsPerByte(__m256i v) {
  const __m256i table = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                         0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i nibble = _mm256_set1_epi8(0x0f);
  const __m256i low = _mm256_and_si256(v, nibble), high = _mm256_and_si256(_mm256_srli_epi16(v, 4), nibble);
  return _mm256_add_epi8(_mm256_shuffle_epi8(table, low), _mm256_shuffle_epi8(table, high));
}

/// The low 32 bits of two registers of four 64-bit numbers, in order.
ENGRAM_AVX2_INLINE __m256i narrow(__m256i a, __m256i b) {
  const __m256 mixed =
      _mm256_shuffle_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b), _MM_SHUFFLE(2, 0, 2, 0));
  return _mm256_permute4x64_epi64(_mm256_castps_si256(mixed), _MM_SHUFFLE(3, 1, 2, 0));
}

/// Distances of one query to the 16 rows of a block. Byte sums hold 31 words of 8 bits; longer rows are cut
/// there.
ENGRAM_AVX2_INLINE void bitDistances(const std::uint64_t* query, const __m256i* block, int units,
                                     __m256i out[4]) {
  constexpr int kWordsPerByteSum = 31;
  for (int r = 0; r < 4; ++r) out[r] = _mm256_setzero_si256();
  for (int start = 0; start < units; start += kWordsPerByteSum) {
    __m256i bytes[4];
    for (int r = 0; r < 4; ++r) bytes[r] = _mm256_setzero_si256();
    for (int u = start; u < units && u < start + kWordsPerByteSum; ++u) {
      const __m256i value = _mm256_set1_epi64x(static_cast<long long>(query[u]));
      for (int r = 0; r < 4; ++r)
        bytes[r] = _mm256_add_epi8(
            bytes[r], bitsPerByte(_mm256_xor_si256(value, _mm256_load_si256(block + 4 * u + r))));
    }
    for (int r = 0; r < 4; ++r)
      out[r] = _mm256_add_epi64(out[r], _mm256_sad_epu8(bytes[r], _mm256_setzero_si256()));
  }
}

template <int Q>
ENGRAM_AVX2 void scanBinary(const DescriptorGroup& queries, int begin, const DescriptorGroup& group,
                            Nearest* out) {
  for (int q = 0; q < Q; ++q) {
    const auto* query = reinterpret_cast<const std::uint64_t*>(queries.row(begin + q));
    const auto* block = reinterpret_cast<const __m256i*>(group.blocks.data());
    Minima minima;
    reset(minima);
    for (int b = 0; b < group.blockCount(); ++b, block += 4 * group.units) {
      __m256i d[4];
      bitDistances(query, block, group.units, d);
      for (int h = 0; h < 2; ++h) {
        const auto* bias = reinterpret_cast<const __m256i*>(group.laneBias.data() + b * kLanes + 8 * h);
        const __m256i bits = _mm256_add_epi32(narrow(d[2 * h], d[2 * h + 1]), _mm256_loadu_si256(bias));
        update(minima, h, _mm256_cvtepi32_ps(bits), _mm256_set1_epi32(b));
      }
    }
    out[q] = join(minima);
  }
}

using Scan = void (*)(const DescriptorGroup&, int, const DescriptorGroup&, Nearest*);

void inFours(Scan four, Scan one, const DescriptorGroup& queries, int begin, int end,
             const DescriptorGroup& group, Nearest* out) {
  int q = begin;
  for (; q + 4 <= end; q += 4) four(queries, q, group, out + (q - begin));
  for (; q < end; ++q) one(queries, q, group, out + (q - begin));
}

}  // namespace

void nearestFloatAvx2(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                      Nearest* out) {
  inFours(scanFloat<4>, scanFloat<1>, queries, begin, end, group, out);
}

void nearestInt8Avx2(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                     Nearest* out) {
  inFours(scanInt8<4>, scanInt8<1>, queries, begin, end, group, out);
}

void nearestBinaryAvx2(const DescriptorGroup& queries, int begin, int end, const DescriptorGroup& group,
                       Nearest* out) {
  inFours(scanBinary<4>, scanBinary<1>, queries, begin, end, group, out);
}

}  // namespace engram::features::detail
#endif

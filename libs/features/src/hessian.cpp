// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One source for all instruction sets: the plain loops below are inlined into one function per level, where
// the compiler vectorises them. Fused multiply-adds stay off, so the results are the same bits.
#include "hessian.h"

#include <cstddef>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace engram::features {
namespace {

#define ENGRAM_INLINE __attribute__((always_inline)) inline

struct Bands {
  std::int32_t* __restrict x;
  std::int32_t* __restrict y;
  std::int32_t* __restrict xy;
};

/// Sums over the rows of the three filters, running along the row: what is left to do is one difference per
/// box.
ENGRAM_INLINE void sumBands(const IntegralImage& image, BoxFilter f, int y, Bands bands) {
  const int l = f.lobe, h = f.half(), m = l / 2, n = image.cols() + 1;
  const std::uint32_t *a0 = image.row(y - l + 1), *a1 = image.row(y + l);
  const std::uint32_t *b0 = image.row(y - h), *b1 = image.row(y + h + 1);
  const std::uint32_t *c0 = image.row(y - m), *c1 = image.row(y + m + 1);
  const std::uint32_t *d0 = image.row(y - l), *d1 = image.row(y), *d2 = image.row(y + 1),
                      *d3 = image.row(y + l + 1);
  for (int x = 0; x < n; ++x) {
    const std::uint32_t middle = c1[x] - c0[x];
    bands.x[x] = static_cast<std::int32_t>(a1[x] - a0[x]);
    bands.y[x] = static_cast<std::int32_t>((b1[x] - b0[x]) - (middle + middle + middle));
    bands.xy[x] = static_cast<std::int32_t>((d1[x] - d0[x]) - (d3[x] - d2[x]));
  }
}

ENGRAM_INLINE void determinants(Bands bands, BoxFilter f, int begin, int end, float* __restrict out) {
  const int l = f.lobe, h = f.half(), m = l / 2;
  const float norm = 1.0f / (255.0f * static_cast<float>(f.size() * f.size()));
  constexpr float kBalance = 0.9f * 0.9f;  // w of Bay 2008, eq (4)
  for (int x = begin; x < end; ++x) {
    const std::int32_t middle = bands.x[x + m + 1] - bands.x[x - m];
    const std::int32_t xx = (bands.x[x + h + 1] - bands.x[x - h]) - (middle + middle + middle);
    const std::int32_t yy = bands.y[x + l] - bands.y[x - l + 1];
    const std::int32_t xy = (bands.xy[x] - bands.xy[x - l]) - (bands.xy[x + l + 1] - bands.xy[x + 1]);
    const float dxx = static_cast<float>(xx) * norm;
    const float dyy = static_cast<float>(yy) * norm;
    const float dxy = static_cast<float>(xy) * norm;
    out[x] = dxx * dyy - kBalance * (dxy * dxy);
  }
}

ENGRAM_INLINE void hessianRow(const IntegralImage& image, BoxFilter f, int y, Bands bands, float* out) {
  sumBands(image, f, y, bands);
  determinants(bands, f, f.half(), image.cols() - f.half(), out);
}

void hessianRowPortable(const IntegralImage& image, BoxFilter f, int y, Bands bands, float* out) {
  hessianRow(image, f, y, bands, out);
}

/// The neighbours before and after the centre in the order layer, row, column.
ENGRAM_INLINE bool isMaximum(const Neighbourhood& n, int x) {
  const float c = n.rows[1][1][x];
  const float* middle = n.rows[1][1];
  if (!(c > middle[x - 1] && c >= middle[x + 1])) return false;
  for (int dx = -1; dx <= 1; ++dx)
    if (!(c > n.rows[1][0][x + dx] && c >= n.rows[1][2][x + dx])) return false;
  for (int r = 0; r < 3; ++r)
    for (int dx = -1; dx <= 1; ++dx)
      if (!(c > n.rows[0][r][x + dx] && c >= n.rows[2][r][x + dx])) return false;
  return true;
}

void findMaximaPortable(const Neighbourhood& n, int begin, int end, float threshold,
                        std::vector<int>& columns) {
  const float* centre = n.rows[1][1];
  for (int x = begin; x < end; ++x)
    if (centre[x] > threshold && isMaximum(n, x)) columns.push_back(x);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void hessianRowAvx2(const IntegralImage& image, BoxFilter f, int y,
                                                    Bands bands, float* out) {
  hessianRow(image, f, y, bands, out);
}

/// Eight columns at a time drop out as early as they can.
__attribute__((target("avx2"))) void findMaximaAvx2(const Neighbourhood& n, int begin, int end,
                                                    float threshold, std::vector<int>& columns) {
  const __m256 limit = _mm256_set1_ps(threshold);
  int x = begin;
  for (; x + 8 <= end; x += 8) {
    const __m256 c = _mm256_loadu_ps(n.rows[1][1] + x);
    __m256 good = _mm256_cmp_ps(c, limit, _CMP_GT_OQ);
    if (_mm256_movemask_ps(good) == 0) continue;
    good = _mm256_and_ps(good, _mm256_cmp_ps(c, _mm256_loadu_ps(n.rows[1][1] + x - 1), _CMP_GT_OQ));
    good = _mm256_and_ps(good, _mm256_cmp_ps(c, _mm256_loadu_ps(n.rows[1][1] + x + 1), _CMP_GE_OQ));
    for (int dx = -1; dx <= 1; ++dx) {
      good = _mm256_and_ps(good, _mm256_cmp_ps(c, _mm256_loadu_ps(n.rows[1][0] + x + dx), _CMP_GT_OQ));
      good = _mm256_and_ps(good, _mm256_cmp_ps(c, _mm256_loadu_ps(n.rows[1][2] + x + dx), _CMP_GE_OQ));
    }
    if (_mm256_movemask_ps(good) == 0) continue;
    for (int r = 0; r < 3; ++r)
      for (int dx = -1; dx <= 1; ++dx) {
        good = _mm256_and_ps(good, _mm256_cmp_ps(c, _mm256_loadu_ps(n.rows[0][r] + x + dx), _CMP_GT_OQ));
        good = _mm256_and_ps(good, _mm256_cmp_ps(c, _mm256_loadu_ps(n.rows[2][r] + x + dx), _CMP_GE_OQ));
      }
    for (int bits = _mm256_movemask_ps(good); bits != 0; bits &= bits - 1)
      columns.push_back(x + __builtin_ctz(bits));
  }
  findMaximaPortable(n, x, end, threshold, columns);
}
#endif

}  // namespace

HessianRows::HessianRows(SimdLevel level, const IntegralImage& image)
    : level_(level),
      image_(image),
      xBand_(image.stride()),
      yBand_(image.stride()),
      xyBand_(image.stride()),
      dense_(image.stride()) {}

void HessianRows::compute(BoxFilter filter, int y, int step, float* out) {
  const Bands bands{xBand_.data(), yBand_.data(), xyBand_.data()};
  float* dense = step == 1 ? out : dense_.data();
#if defined(__x86_64__)
  if (level_ >= SimdLevel::kAvx2)
    hessianRowAvx2(image_, filter, y, bands, dense);
  else
#endif
    hessianRowPortable(image_, filter, y, bands, dense);
  if (step == 1) return;
  const int end = image_.cols() - filter.half();
  for (int i = (filter.half() + step - 1) / step; i * step < end; ++i) out[i] = dense[i * step];
}

int laplacianSign(const IntegralImage& image, BoxFilter f, int y, int x) {
  const auto box = [&](int y0, int y1, int x0, int x1) {
    return static_cast<std::int32_t>((image.row(y1)[x1] - image.row(y1)[x0]) -
                                     (image.row(y0)[x1] - image.row(y0)[x0]));
  };
  const int l = f.lobe, h = f.half(), m = l / 2;
  const auto xx = box(y - l + 1, y + l, x - h, x + h + 1) - 3 * box(y - l + 1, y + l, x - m, x + m + 1);
  const auto yy = box(y - h, y + h + 1, x - l + 1, x + l) - 3 * box(y - m, y + m + 1, x - l + 1, x + l);
  return xx + yy < 0 ? -1 : 1;
}

void findMaxima(SimdLevel level, const Neighbourhood& n, int begin, int end, float threshold,
                std::vector<int>& columns) {
#if defined(__x86_64__)
  if (level >= SimdLevel::kAvx2) return findMaximaAvx2(n, begin, end, threshold, columns);
#endif
  static_cast<void>(level);
  findMaximaPortable(n, begin, end, threshold, columns);
}

}  // namespace engram::features

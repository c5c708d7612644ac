// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// As in hessian.cpp the plain loops are compiled once per instruction set and give the same bits.
#include "surf_descriptor.h"

#include "surf_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace engram::features {
namespace {

#define ENGRAM_INLINE __attribute__((always_inline)) inline

constexpr int kGrid = static_cast<int>(kSurfWindow);  // samples on a side of the window, one scale apart
constexpr int kSamples = kGrid * kGrid;
constexpr int kCells = 4;   // on a side
constexpr int kDisc = 112;  // samples of the orientation disc, padded to whole registers
constexpr int kDiscRadius = 6;
constexpr int kBins = 60, kWindowBins = 10;  // the window of pi / 3 slides by 6 degrees

/// Where to sample around a keypoint, in units of the scale, and with what weight.
template <int N>
struct Pattern {
  alignas(32) float x[N] = {}, y[N] = {}, weight[N] = {};
};

/// The samples of the descriptor window; their weights are in cellWeights().
const Pattern<kSamples>& windowPattern() {
  static const auto pattern = [] {
    Pattern<kSamples> p;
    for (int i = 0; i < kSamples; ++i) {
      p.x[i] = static_cast<float>(i % kGrid) - (kGrid - 1) / 2.0f;
      p.y[i] = static_cast<float>(i / kGrid) - (kGrid - 1) / 2.0f;
      p.weight[i] = 1.0f;
    }
    return p;
  }();
  return pattern;
}

/// What a row or column of samples contributes to a row or column of cells: weight[cell][sample]. Cells of 9
/// samples overlap by 4; a Gaussian of 2.5 scales within each and one of 1.5 cells over the window (Agrawal,
/// Konolige & Blas 2008, section 4.1). Bay's hard cells lose a seventh of the correct matches on real images.
struct CellWeights {
  alignas(32) float weight[kCells][kGrid] = {};
  int begin[kCells], end[kCells];  ///< samples of non-zero weight
};
const CellWeights& cellWeights() {
  static const auto weights = [] {
    constexpr double kPitch = 5, kReach = 5, kCellSigma = 2.5, kWindowSigma = 1.5;
    CellWeights w;
    for (int c = 0; c < kCells; ++c) {
      const double cell = c - (kCells - 1) / 2.0;
      w.begin[c] = kGrid;
      w.end[c] = 0;
      for (int i = 0; i < kGrid; ++i) {
        const double d = i - (kGrid - 1) / 2.0 - cell * kPitch;
        if (std::abs(d) >= kReach) continue;
        w.weight[c][i] = static_cast<float>(std::exp(-d * d / (2 * kCellSigma * kCellSigma) -
                                                     cell * cell / (2 * kWindowSigma * kWindowSigma)));
        w.begin[c] = std::min(w.begin[c], i);
        w.end[c] = i + 1;
      }
    }
    return w;
  }();
  return weights;
}

/// Grid points of a disc of radius 6, weighted by a Gaussian of 2.5 scales.
const Pattern<kDisc>& discPattern() {
  static const auto pattern = [] {
    Pattern<kDisc> p;
    int n = 0;
    for (int y = -kDiscRadius; y <= kDiscRadius; ++y)
      for (int x = -kDiscRadius; x <= kDiscRadius; ++x) {
        if (x * x + y * y >= kDiscRadius * kDiscRadius) continue;
        p.x[n] = static_cast<float>(x);
        p.y[n] = static_cast<float>(y);
        p.weight[n++] = static_cast<float>(std::exp(-(x * x + y * y) / (2 * 2.5 * 2.5)));
      }
    return p;
  }();
  return pattern;
}

/// The grid turned, scaled and moved to the keypoint.
struct Placement {
  float x, y, scale, cosine, sine;
  int half;  ///< half the side of the Haar filters [px]
};

ENGRAM_INLINE int floorToInt(float v) {
  const int t = static_cast<int>(v);
  return t - (static_cast<float>(t) > v ? 1 : 0);
}

/// Haar responses at all samples of a pattern, in image axes, weighted. The edge between the halves of a
/// filter is the pixel edge next to the sample: pixel k covers [k - 0.5, k + 0.5), which is column k to k + 1
/// of the integral image.
template <int N>
ENGRAM_INLINE void haarResponses(const IntegralImage& image, const Pattern<N>& pattern, const Placement& at,
                                 float* __restrict outX, float* __restrict outY) {
  alignas(32) int offset[N];
  alignas(32) float weight[N];
  const int h = at.half, stride = static_cast<int>(image.stride()), cols = image.cols(), rows = image.rows();
  const float c = at.cosine * at.scale, s = at.sine * at.scale;
  for (int i = 0; i < N; ++i) {
    const int x = floorToInt(at.x + c * pattern.x[i] - s * pattern.y[i] + 1.0f);
    const int y = floorToInt(at.y + s * pattern.x[i] + c * pattern.y[i] + 1.0f);
    const bool fits = (x >= h) & (y >= h) & (x <= cols - h) & (y <= rows - h);
    offset[i] = fits ? y * stride + x : h * stride + h;
    weight[i] = fits ? pattern.weight[i] : 0.0f;
  }
  const std::uint32_t* sums = image.row(0);
  const int down = h * stride;
  for (int i = 0; i < N; ++i) {
    const std::uint32_t* p = sums + offset[i];
    const std::uint32_t a = p[-down - h], b = p[-down], e = p[-down + h];
    const std::uint32_t d = p[-h], f = p[h];
    const std::uint32_t g = p[down - h], k = p[down], m = p[down + h];
    const auto x = static_cast<std::int32_t>((m - e) - 2 * (k - b) + (g - a));
    const auto y = static_cast<std::int32_t>((m - g) - 2 * (f - d) + (e - a));
    outX[i] = static_cast<float>(x) * weight[i];
    outY[i] = static_cast<float>(y) * weight[i];
  }
}

/// Direction in units of bins, in [0, kBins), to about 0.01 of a bin: what is binned needs no more.
ENGRAM_INLINE float binOf(float x, float y) {
  const float ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const float small = ax < ay ? ax : ay, large = ax < ay ? ay : ax;
  const float t = small / (large + 1e-20f), t2 = t * t;
  float angle =
      t * (0.99997726f + t2 * (-0.33262347f + t2 * (0.19354346f + t2 * (-0.11643287f + t2 * 0.05265332f))));
  angle = ay > ax ? std::numbers::pi_v<float> / 2 - angle : angle;
  angle = x < 0 ? std::numbers::pi_v<float> - angle : angle;
  angle = y < 0 ? 2 * std::numbers::pi_v<float> - angle : angle;
  const float bin = angle * (kBins / (2 * std::numbers::pi_v<float>));
  return bin < kBins ? bin : 0.0f;
}

ENGRAM_INLINE void orientationBins(const IntegralImage& image, const Placement& at, float sumX[kBins],
                                   float sumY[kBins]) {
  alignas(32) float x[kDisc], y[kDisc], bin[kDisc];
  haarResponses(image, discPattern(), at, x, y);
  for (int i = 0; i < kDisc; ++i) bin[i] = binOf(x[i], y[i]);
  for (int i = 0; i < kBins; ++i) sumX[i] = sumY[i] = 0;
  for (int i = 0; i < kDisc; ++i) {
    const int b = static_cast<int>(bin[i]);
    sumX[b] += x[i];
    sumY[b] += y[i];
  }
}

ENGRAM_INLINE void regionSums(const IntegralImage& image, const Placement& at, float* __restrict out) {
  alignas(32) float x[kSamples], y[kSamples], along[kSamples], across[kSamples];
  haarResponses(image, windowPattern(), at, x, y);
  for (int i = 0; i < kSamples; ++i) {
    along[i] = at.cosine * x[i] + at.sine * y[i];
    across[i] = at.cosine * y[i] - at.sine * x[i];
  }
  // The weights are separable: first over the rows of samples, then along them.
  const CellWeights& cells = cellWeights();
  for (int r = 0; r < kCells; ++r) {
    alignas(32) float sum[4][kGrid] = {};
    for (int j = cells.begin[r]; j < cells.end[r]; ++j) {
      const float w = cells.weight[r][j];
      const float *u = along + j * kGrid, *v = across + j * kGrid;
      for (int i = 0; i < kGrid; ++i) {
        sum[0][i] += w * u[i];
        sum[1][i] += w * v[i];
        sum[2][i] += w * (u[i] < 0 ? -u[i] : u[i]);
        sum[3][i] += w * (v[i] < 0 ? -v[i] : v[i]);
      }
    }
    for (int c = 0; c < kCells; ++c)
      for (int k = 0; k < 4; ++k) {
        float total = 0;
        for (int i = cells.begin[c]; i < cells.end[c]; ++i) total += sum[k][i] * cells.weight[c][i];
        out[(kCells * r + c) * 4 + k] = total;
      }
  }
}

void orientationBinsPortable(const IntegralImage& image, const Placement& at, float x[kBins],
                             float y[kBins]) {
  orientationBins(image, at, x, y);
}
void regionSumsPortable(const IntegralImage& image, const Placement& at, float* out) {
  regionSums(image, at, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void orientationBinsAvx2(const IntegralImage& image, const Placement& at,
                                                         float x[kBins], float y[kBins]) {
  orientationBins(image, at, x, y);
}
__attribute__((target("avx2"))) void regionSumsAvx2(const IntegralImage& image, const Placement& at,
                                                    float* out) {
  regionSums(image, at, out);
}
#endif

int atLeastOne(float v) { return std::max(1, static_cast<int>(std::lround(v))); }

}  // namespace

float surfAngle(SimdLevel level, const IntegralImage& image, const types::Keypoint& k) {
  const float scale = k.size / kSurfWindow;
  const Placement at{k.x, k.y, scale, 1.0f, 0.0f, atLeastOne(2 * scale)};
  float x[kBins], y[kBins];
#if defined(__x86_64__)
  if (level >= SimdLevel::kAvx2)
    orientationBinsAvx2(image, at, x, y);
  else
#endif
    orientationBinsPortable(image, at, x, y);
  static_cast<void>(level);
  double sumX = 0, sumY = 0, best = -1, bestX = 1, bestY = 0;
  for (int last = 0; last < kBins + kWindowBins; ++last) {
    sumX += x[last % kBins];
    sumY += y[last % kBins];
    if (last < kWindowBins) continue;
    sumX -= x[last - kWindowBins];
    sumY -= y[last - kWindowBins];
    const double strength = sumX * sumX + sumY * sumY;
    if (strength <= best) continue;
    best = strength;
    bestX = sumX;
    bestY = sumY;
  }
  return static_cast<float>(std::atan2(bestY, bestX));
}

void surfDescriptor(SimdLevel level, const IntegralImage& image, const types::Keypoint& k,
                    float out[kSurfDim]) {
  const float scale = k.size / kSurfWindow;
  const Placement at{k.x, k.y, scale, std::cos(k.angle), std::sin(k.angle), atLeastOne(scale)};
#if defined(__x86_64__)
  if (level >= SimdLevel::kAvx2)
    regionSumsAvx2(image, at, out);
  else
#endif
    regionSumsPortable(image, at, out);
  static_cast<void>(level);
  double squares = 0;
  for (int i = 0; i < kSurfDim; ++i) squares += static_cast<double>(out[i]) * out[i];
  if (squares <= 0) return;
  const auto norm = static_cast<float>(1 / std::sqrt(squares));
  for (int i = 0; i < kSurfDim; ++i) out[i] *= norm;
}

}  // namespace engram::features

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/row_matcher.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace engram::odometry {
namespace {

constexpr int kHalfHeight = 5, kHeight = 2 * kHalfHeight + 1;
constexpr int kBefore = 8, kWidth = 16;         // columns u - 8 … u + 7
constexpr int kTexture = 4 * kHeight * kWidth;  // smallest sum of absolute gradients
constexpr double kCostRatio = 1.05;             // the second best must be worse by this factor
constexpr double kSmall = 0.6;  // largest difference, as a share of the window's own gradients
constexpr int kLargestSearch = 1024;
constexpr float kMinDisparity = 0.5f;

int sad(const std::uint8_t* a, std::size_t stepA, const std::uint8_t* b, std::size_t stepB) {
#if defined(__SSE2__)
  __m128i sum = _mm_setzero_si128();
  for (int y = 0; y < kHeight; ++y, a += stepA, b += stepB)
    sum = _mm_add_epi64(sum, _mm_sad_epu8(_mm_loadu_si128(reinterpret_cast<const __m128i*>(a)),
                                          _mm_loadu_si128(reinterpret_cast<const __m128i*>(b))));
  return _mm_cvtsi128_si32(sum) + _mm_cvtsi128_si32(_mm_srli_si128(sum, 8));
#else
  int sum = 0;
  for (int y = 0; y < kHeight; ++y, a += stepA, b += stepB)
    for (int x = 0; x < kWidth; ++x) sum += std::abs(a[x] - b[x]);
  return sum;
#endif
}

const std::uint8_t* windowAt(const cv::Mat& image, int u, int v) {
  return image.ptr<std::uint8_t>(v - kHalfHeight) + (u - kBefore);
}

bool windowInside(const cv::Mat& image, int u, int v) {
  return u >= kBefore && u + kWidth - kBefore <= image.cols && v >= kHalfHeight &&
         v + kHalfHeight < image.rows;
}

cv::Mat smooth(const cv::Mat& image) {
  cv::Mat out;
  cv::GaussianBlur(image, out, {5, 5}, 1.0);
  return out;
}

/// Horizontal gradient around 128, twice the difference of the neighbours: bright and dark images of one
/// scene look alike, and only vertical edges tell a disparity.
cv::Mat gradientOf(const cv::Mat& image) {
  cv::Mat difference, gradient;
  cv::Sobel(image, difference, CV_16S, 1, 0);
  difference.convertTo(gradient, CV_8U, 0.5, 128);
  return gradient;
}

struct CheapestRow {
  int at = -1, cost = 1 << 30;
  bool distinct = false;
};

/// The best of costs[low … high], and whether it is better than all that are not its neighbours.
CheapestRow bestOf(const std::array<int, kLargestSearch>& costs, int low, int high) {
  CheapestRow best;
  for (int d = low; d <= high; ++d)
    if (costs[static_cast<std::size_t>(d - low)] < best.cost) {
      best.cost = costs[static_cast<std::size_t>(d - low)];
      best.at = d;
    }
  int second = 1 << 30;
  for (int d = low; d <= high; ++d)
    if (std::abs(d - best.at) > 2) second = std::min(second, costs[static_cast<std::size_t>(d - low)]);
  best.distinct = second > kCostRatio * best.cost;
  return best;
}

}  // namespace

RowMatcher::RowMatcher(const types::StereoPair& pair, int maxDisparity)
    : left_(smooth(pair.left)),
      right_(smooth(pair.right)),
      gradientLeft_(gradientOf(left_)),
      gradientRight_(gradientOf(right_)),
      maxDisparity_(std::min(maxDisparity, kLargestSearch - 1)) {}

std::optional<float> RowMatcher::disparity(float u, float v) const { return search(u, v, 0, maxDisparity_); }

std::optional<float> RowMatcher::disparity(float u, float v, float expected, int reach) const {
  const int middle = static_cast<int>(std::lround(expected));
  return search(u, v, std::max(0, middle - reach), std::min(maxDisparity_, middle + reach));
}

std::optional<float> RowMatcher::search(float u, float v, int low, int high) const {
  const int iu = static_cast<int>(std::lround(u)), iv = static_cast<int>(std::lround(v));
  if (!windowInside(gradientLeft_, iu, iv)) return std::nullopt;
  high = std::min(high, iu - kBefore);
  if (high < low) return std::nullopt;
  const std::uint8_t* left = windowAt(gradientLeft_, iu, iv);
  static const std::array<std::uint8_t, kWidth> flat = [] {
    std::array<std::uint8_t, kWidth> row{};
    row.fill(128);
    return row;
  }();
  const int texture = sad(left, gradientLeft_.step, flat.data(), 0);
  if (texture < kTexture) return std::nullopt;
  std::array<int, kLargestSearch> costs;
  for (int d = low; d <= high; ++d)
    costs[static_cast<std::size_t>(d - low)] =
        sad(left, gradientLeft_.step, windowAt(gradientRight_, iu - d, iv), gradientRight_.step);
  const CheapestRow best = bestOf(costs, low, high);
  if (!best.distinct || best.cost > kSmall * texture) return std::nullopt;
  // From right to left the same match must be the best one.
  const int right = iu - best.at;
  const std::uint8_t* back = windowAt(gradientRight_, right, iv);
  const int last = std::min(high, gradientLeft_.cols - kWidth + kBefore - right);
  for (int d = low; d <= last; ++d)
    if (std::abs(d - best.at) > 1 && sad(back, gradientRight_.step, windowAt(gradientLeft_, right + d, iv),
                                         gradientLeft_.step) < best.cost)
      return std::nullopt;
  return refine(u, v, best.at);
}

/// Gauss-Newton on the grey levels along the row, with a free offset of brightness (Lucas & Kanade 1981).
std::optional<float> RowMatcher::refine(float u, float v, int start) const {
  constexpr int kHalf = 5, kSide = 2 * kHalf + 1;
  const auto patch = [](const cv::Mat& image, float x, float y, int columns, float* out) {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    if (ix < 0 || iy < 0 || ix + columns >= image.cols || iy + kSide >= image.rows) return false;
    for (int r = 0; r < kSide; ++r) {
      const auto *top = image.ptr<std::uint8_t>(iy + r) + ix,
                 *bottom = image.ptr<std::uint8_t>(iy + r + 1) + ix;
      for (int c = 0; c < columns; ++c, ++out)
        *out = (1 - fy) * ((1 - fx) * top[c] + fx * top[c + 1]) +
               fy * ((1 - fx) * bottom[c] + fx * bottom[c + 1]);
    }
    return true;
  };
  std::array<float, kSide * kSide> left;
  std::array<float, kSide*(kSide + 2)> right;
  if (!patch(left_, u - kHalf, v - kHalf, kSide, left.data())) return std::nullopt;
  float d = static_cast<float>(start);
  for (int iteration = 0; iteration < 6; ++iteration) {
    if (!patch(right_, u - d - kHalf - 1, v - kHalf, kSide + 2, right.data())) return std::nullopt;
    float sumG = 0, sumE = 0, sumGG = 0, sumGE = 0;
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        const float* at = &right[static_cast<std::size_t>(r * (kSide + 2) + c + 1)];
        const float g = 0.5f * (at[1] - at[-1]);
        const float e = *at - left[static_cast<std::size_t>(r * kSide + c)];
        sumG += g, sumE += e, sumGG += g * g, sumGE += g * e;
      }
    constexpr float kPixels = kSide * kSide;
    const float curvature = sumGG - sumG * sumG / kPixels;
    if (!(curvature > 1)) return std::nullopt;
    const float step = (sumGE - sumG * sumE / kPixels) / curvature;
    d += step;
    if (std::abs(d - static_cast<float>(start)) > 2) return std::nullopt;
    if (std::abs(step) < 0.01f) break;
  }
  if (!(d >= kMinDisparity)) return std::nullopt;
  return d;
}

}  // namespace engram::odometry

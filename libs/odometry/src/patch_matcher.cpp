// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "patch_matcher.h"

#include "corners.h"

#include <algorithm>
#include <cmath>

namespace engram::odometry {
namespace {

constexpr int kThreshold = 12;        // grey levels of a corner
constexpr float kSimilar = 0.85f;     // correlation
constexpr float kDistinct = 0.05f;    // by which the second best must be worse
constexpr float kFewestContrast = 4;  // deviation of the grey levels of a patch

float correlation(const Patch& a, const Patch& b) {
  float sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += a.pixels[i] * b.pixels[i];
  return sum;
}

bool normalise(Patch& patch) {
  float mean = 0, squares = 0;
  for (const float p : patch.pixels) mean += p / Patch::kPixels;
  for (float& p : patch.pixels) {
    p -= mean;
    squares += p * p;
  }
  if (squares < kFewestContrast * kFewestContrast * Patch::kPixels) return false;
  const float scale = 1 / std::sqrt(squares);
  for (float& p : patch.pixels) p *= scale;
  return true;
}

struct BestPatch {
  int at = -1;
  float first = -1, second = -1;
  void offer(int index, float value) {
    if (value > first) {
      second = first;
      first = value;
      at = index;
    } else {
      second = std::max(second, value);
    }
  }
  bool good() const { return first >= kSimilar && first >= second + kDistinct; }
};

constexpr int kRadius = 4, kWindowSide = 2 * kRadius + 1;
using Window = std::array<float, kWindowSide * kWindowSide>;

/// Between the pixels, of zero mean; false where it is not inside.
bool sample(const cv::Mat& image, cv::Point2f centre, Window& out) {
  const float x = centre.x - kRadius, y = centre.y - kRadius;
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  if (ix < 0 || iy < 0 || ix + kWindowSide >= image.cols || iy + kWindowSide >= image.rows) return false;
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  const float w00 = (1 - fx) * (1 - fy), w01 = fx * (1 - fy), w10 = (1 - fx) * fy, w11 = fx * fy;
  float sum = 0;
  for (int r = 0; r < kWindowSide; ++r) {
    const auto *top = image.ptr<std::uint8_t>(iy + r) + ix,
               *bottom = image.ptr<std::uint8_t>(iy + r + 1) + ix;
    for (int c = 0; c < kWindowSide; ++c) {
      const float value = w00 * top[c] + w01 * top[c + 1] + w10 * bottom[c] + w11 * bottom[c + 1];
      out[static_cast<std::size_t>(r * kWindowSide + c)] = value;
      sum += value;
    }
  }
  for (float& value : out) value -= sum / (kWindowSide * kWindowSide);
  return true;
}

}  // namespace

float similarity(const cv::Mat& imageA, cv::Point2f a, const cv::Mat& imageB, cv::Point2f b) {
  Window p, q;
  if (!sample(imageA, a, p) || !sample(imageB, b, q)) return -1;
  float pq = 0, pp = 0, qq = 0;
  for (std::size_t i = 0; i < p.size(); ++i) pq += p[i] * q[i], pp += p[i] * p[i], qq += q[i] * q[i];
  const float scale = std::sqrt(pp * qq);
  return scale > 0 ? pq / scale : 0;
}

std::vector<Patch> cornerPatches(const cv::Mat& image, int wanted) {
  std::vector<Patch> patches;
  for (const auto& corner : gridCorners(image, {}, wanted, kThreshold)) {
    Patch patch{corner.x, corner.y, {}};
    auto* to = patch.pixels.data();
    for (int y = -Patch::kHalf; y <= Patch::kHalf; ++y) {
      const auto* row = image.ptr<std::uint8_t>(static_cast<int>(corner.y) + y) + static_cast<int>(corner.x);
      for (int x = -Patch::kHalf; x <= Patch::kHalf; ++x) *to++ = row[x];
    }
    if (normalise(patch)) patches.push_back(patch);
  }
  std::sort(patches.begin(), patches.end(),
            [](const Patch& a, const Patch& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return patches;
}

std::vector<Shift> matchPatches(std::span<const Patch> a, std::span<const Patch> b, float columns,
                                float rows) {
  std::vector<BestPatch> forward(a.size()), backward(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    auto j = static_cast<std::size_t>(
        std::lower_bound(b.begin(), b.end(), a[i].y - rows, [](const Patch& p, float y) { return p.y < y; }) -
        b.begin());
    for (; j < b.size() && b[j].y <= a[i].y + rows; ++j) {
      if (std::abs(b[j].x - a[i].x) > columns) continue;
      const float value = correlation(a[i], b[j]);
      forward[i].offer(static_cast<int>(j), value);
      backward[j].offer(static_cast<int>(i), value);
    }
  }
  std::vector<Shift> shifts;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!forward[i].good()) continue;
    const auto& back = backward[static_cast<std::size_t>(forward[i].at)];
    const auto& match = b[static_cast<std::size_t>(forward[i].at)];
    if (back.at == static_cast<int>(i) && back.good()) shifts.push_back({a[i].x - match.x, a[i].y - match.y});
  }
  return shifts;
}

}  // namespace engram::odometry

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

namespace engram::features {
namespace {

constexpr int kRingPoints = 12;

auto sortKey(const types::Keypoint& k) { return std::tuple(-k.response, k.y, k.x, k.size, k.angle, k.sign); }

void sortByStrength(std::span<const types::Keypoint> keypoints, std::vector<int>& indices) {
  std::sort(indices.begin(), indices.end(), [&](int i, int j) {
    const auto a = sortKey(keypoints[static_cast<std::size_t>(i)]),
               b = sortKey(keypoints[static_cast<std::size_t>(j)]);
    return std::tie(a, i) < std::tie(b, j);
  });
}

std::vector<int> iota(std::size_t n) {
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

using Ring = std::array<cv::Point2f, kRingPoints>;

Ring unitRing() {
  Ring ring;
  for (int i = 0; i < kRingPoints; ++i) {
    const double a = 2 * std::numbers::pi * i / kRingPoints;
    ring[static_cast<std::size_t>(i)] =
        cv::Point2f(static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)));
  }
  return ring;
}

bool masked(const cv::Mat& mask, float x, float y) {
  const int c = static_cast<int>(std::lround(x)), r = static_cast<int>(std::lround(y));
  return c >= 0 && r >= 0 && c < mask.cols && r < mask.rows && mask.at<std::uint8_t>(r, c) == 0;
}

bool isInside(const types::Keypoint& k, const cv::Mat& mask, double margin, const Ring& ring) {
  if (masked(mask, k.x, k.y)) return false;
  const float radius = static_cast<float>(margin) * k.size / 2;
  return std::none_of(ring.begin(), ring.end(), [&](cv::Point2f p) {
    return masked(mask, k.x + radius * p.x, k.y + radius * p.y) ||
           masked(mask, k.x + radius / 2 * p.x, k.y + radius / 2 * p.y);
  });
}

/// Moves the first members of each cell, up to its share, to the front; keeps the order within both parts.
void spread(std::span<const types::Keypoint> keypoints, std::vector<int>& byStrength, cv::Size size,
            int count, int cells) {
  const int share = (count + cells * cells - 1) / (cells * cells);
  std::vector<int> used(static_cast<std::size_t>(cells * cells), 0);
  const auto cellOf = [cells](float v, int extent) {
    return std::clamp(static_cast<int>(v * static_cast<float>(cells) / static_cast<float>(extent)), 0,
                      cells - 1);
  };
  std::stable_partition(byStrength.begin(), byStrength.end(), [&](int i) {
    const auto& k = keypoints[static_cast<std::size_t>(i)];
    const int cell = cellOf(k.y, size.height) * cells + cellOf(k.x, size.width);
    return used[static_cast<std::size_t>(cell)]++ < share;
  });
}

}  // namespace

std::vector<int> strongestFirst(std::span<const types::Keypoint> keypoints) {
  auto order = iota(keypoints.size());
  sortByStrength(keypoints, order);
  return order;
}

std::vector<int> insideMask(std::span<const types::Keypoint> keypoints, const cv::Mat& mask, double margin) {
  auto inside = iota(keypoints.size());
  if (mask.empty()) return inside;
  const Ring ring = unitRing();
  std::erase_if(inside,
                [&](int i) { return !isInside(keypoints[static_cast<std::size_t>(i)], mask, margin, ring); });
  return inside;
}

std::vector<int> strongest(std::span<const types::Keypoint> keypoints, std::vector<int> candidates,
                           cv::Size imageSize, int count, int gridCells) {
  sortByStrength(keypoints, candidates);
  if (gridCells > 0) spread(keypoints, candidates, imageSize, count, gridCells);
  if (candidates.size() > static_cast<std::size_t>(count)) candidates.resize(static_cast<std::size_t>(count));
  sortByStrength(keypoints, candidates);
  return candidates;
}

}  // namespace engram::features

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "corners.h"

#include <opencv2/features2d.hpp>

#include <algorithm>
#include <cmath>

namespace engram::odometry {
namespace {

constexpr int kPerCell = 4;
constexpr int kBorder = 8;  // [px]: the patch of a corner must lie inside

bool stronger(const cv::KeyPoint& a, const cv::KeyPoint& b) {
  if (a.response != b.response) return a.response > b.response;
  return a.pt.y != b.pt.y ? a.pt.y < b.pt.y : a.pt.x < b.pt.x;
}

}  // namespace

std::vector<cv::Point2f> gridCorners(const cv::Mat& image, const cv::Mat& mask, int wanted, int threshold) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(image, found, threshold, true);
  const double cells = std::max(1.0, static_cast<double>(wanted) / kPerCell);
  const double side = std::sqrt(static_cast<double>(image.total()) / cells);
  const int columns = std::max(1, static_cast<int>(image.cols / side));
  const int rows = std::max(1, static_cast<int>(cells / columns));
  std::vector<std::vector<cv::KeyPoint>> grid(static_cast<std::size_t>(columns * rows));
  for (const auto& k : found) {
    const int x = static_cast<int>(k.pt.x), y = static_cast<int>(k.pt.y);
    if (x < kBorder || y < kBorder || x >= image.cols - kBorder || y >= image.rows - kBorder) continue;
    if (!mask.empty() && mask.at<std::uint8_t>(y, x) == 0) continue;
    grid[static_cast<std::size_t>(y * rows / image.rows * columns + x * columns / image.cols)].push_back(k);
  }
  std::vector<cv::KeyPoint> chosen, rest;
  for (auto& cell : grid) {
    const auto kept = static_cast<std::ptrdiff_t>(std::min<std::size_t>(kPerCell, cell.size()));
    std::partial_sort(cell.begin(), cell.begin() + kept, cell.end(), stronger);
    chosen.insert(chosen.end(), cell.begin(), cell.begin() + kept);
    rest.insert(rest.end(), cell.begin() + kept, cell.end());
  }
  const auto room = std::max<std::ptrdiff_t>(0, wanted - std::ssize(chosen));
  const auto more = std::min(room, std::ssize(rest));
  std::partial_sort(rest.begin(), rest.begin() + more, rest.end(), stronger);
  chosen.insert(chosen.end(), rest.begin(), rest.begin() + more);
  std::vector<cv::Point2f> corners;
  for (const auto& k : chosen) corners.push_back(k.pt);
  return corners;
}

}  // namespace engram::odometry

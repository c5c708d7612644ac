// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <array>
#include <span>
#include <vector>

namespace engram::odometry {

/// A corner with its surroundings, of zero mean and unit length.
struct Patch {
  static constexpr int kHalf = 5, kSide = 2 * kHalf + 1, kPixels = kSide * kSide;
  float x = 0, y = 0;
  std::array<float, kPixels> pixels{};
};

/// The patches of at most `wanted` corners, by their rows.
std::vector<Patch> cornerPatches(const cv::Mat& image, int wanted);

/// Correlation, -1 to 1, of the surroundings of a point of one image and of one of another, 9 x 9 pixels; -1
/// where one of them reaches beyond its image.
float similarity(const cv::Mat& imageA, cv::Point2f a, const cv::Mat& imageB, cv::Point2f b);

/// Where a patch of one image was found in another: how much further left and how much higher [px].
struct Shift {
  float left = 0, up = 0;
};

/// Patches that are each other's most similar ones, and distinct, within `columns` to the left and to the
/// right and `rows` up and down.
std::vector<Shift> matchPatches(std::span<const Patch> a, std::span<const Patch> b, float columns,
                                float rows);

}  // namespace engram::odometry

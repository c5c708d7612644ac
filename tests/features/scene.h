// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"
#include "engram/types/match.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <vector>

namespace engram::features::test {

/// A grey image rich in blobs, edges and corners of all scales.
cv::Mat texturedScene(int width, int height, std::uint64_t seed);

/// Rotation [rad] and scale about the centre of the image.
cv::Matx33d similarity(cv::Size size, double angle, double scale);

/// The image as seen through H (pixel of `image` to pixel of the result), then gain, offset and Gaussian
/// noise.
struct Photometry {
  double gain = 1, offset = 0, noise = 0;
};
cv::Mat warped(const cv::Mat& image, const cv::Matx33d& H, const Photometry& photometry, std::uint64_t seed);

/// How well the features of an image and of its warped copy agree.
struct Agreement {
  int visible = 0;   ///< features of the first image that lie in the second
  int repeated = 0;  ///< of these, found again within `tolerance` px
  int matches = 0;   ///< mutual nearest neighbours that pass the ratio test
  int correct = 0;   ///< of these, within `tolerance` px of where H puts them
  double repeatability() const { return visible ? double(repeated) / visible : 0; }
  double precision() const { return matches ? double(correct) / matches : 0; }
};
Agreement compare(const std::vector<cv::Point2f>& a, const std::vector<cv::Point2f>& b,
                  const std::vector<types::Match>& matches, const cv::Matx33d& H, cv::Size size,
                  double tolerance);

std::vector<cv::Point2f> points(const types::Features& features);

}  // namespace engram::features::test

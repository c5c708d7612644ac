// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <vector>

namespace engram::odometry {

/// FAST corners (Rosten & Drummond 2006), at most `wanted`: the strongest of each cell of a grid, so that
/// they are spread, and where cells are empty the strongest of the others.
/// @param mask CV_8U, 0 where none are wanted; may be empty.
std::vector<cv::Point2f> gridCorners(const cv::Mat& image, const cv::Mat& mask, int wanted, int threshold);

}  // namespace engram::odometry

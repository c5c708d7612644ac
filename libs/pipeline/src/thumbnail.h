// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace engram::pipeline {

/// A small JPEG of an image, for people to look at; `width` in pixels, never larger than the image.
std::vector<std::uint8_t> thumbnail(const cv::Mat& image, int width);

}  // namespace engram::pipeline

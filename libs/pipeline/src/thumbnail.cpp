// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "thumbnail.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace engram::pipeline {

std::vector<std::uint8_t> thumbnail(const cv::Mat& image, int width) {
  const double factor = std::min(1.0, static_cast<double>(width) / image.cols);
  cv::Mat small;
  cv::resize(image, small, {}, factor, factor, cv::INTER_AREA);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, 70});
  return bytes;
}

}  // namespace engram::pipeline

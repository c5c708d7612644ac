// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "integral_image.h"

namespace engram::features {

IntegralImage::IntegralImage(const cv::Mat& grey)
    : rows_(grey.rows),
      cols_(grey.cols),
      stride_(static_cast<std::size_t>(grey.cols) + 1),
      sums_(stride_ * (static_cast<std::size_t>(grey.rows) + 1), 0) {
  for (int y = 0; y < rows_; ++y) {
    const std::uint8_t* pixels = grey.ptr<std::uint8_t>(y);
    const std::uint32_t* above = row(y) + 1;
    std::uint32_t* out = sums_.data() + static_cast<std::size_t>(y + 1) * stride_ + 1;
    std::uint32_t sum = 0;
    for (int x = 0; x < cols_; ++x) {
      sum += pixels[x];
      out[x] = above[x] + sum;
    }
  }
}

}  // namespace engram::features

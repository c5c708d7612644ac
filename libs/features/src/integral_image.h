// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::features {

/// Sums over rectangles in four look-ups. at(y, x) is the sum of all pixels of rows < y and columns < x. Sums
/// wrap modulo 2³², so differences are right for every rectangle of less than 16 million pixels.
class IntegralImage {
 public:
  /// @param grey 8 bit, one channel.
  explicit IntegralImage(const cv::Mat& grey);

  int rows() const { return rows_; }  ///< of the image
  int cols() const { return cols_; }
  std::size_t stride() const { return stride_; }
  const std::uint32_t* row(int y) const { return sums_.data() + static_cast<std::size_t>(y) * stride_; }

 private:
  int rows_, cols_;
  std::size_t stride_;
  std::vector<std::uint32_t> sums_;
};

}  // namespace engram::features

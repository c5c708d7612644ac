// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::apps {

/// As many different places as wanted out of a few images. Each place is one image turned by quarters,
/// mirrored, cut to a window of it and lit anew; the window is scaled to the size of the image.
/// Deterministic.
class BenchImages {
 public:
  /// @param images 8 bit, all of one size; at least one
  BenchImages(std::vector<cv::Mat> images, std::uint64_t seed);

  /// What place i looks like. Places that follow each other come from images that do.
  cv::Mat place(std::size_t i) const;
  /// The same place at another hour, from a little beside it.
  cv::Mat query(std::size_t i) const;

 private:
  cv::Mat seen(std::size_t i, bool again) const;

  std::vector<cv::Mat> images_;
  std::uint64_t seed_;
};

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/texture.h"

#include "engram/base/error.h"

#include <opencv2/imgproc.hpp>

#include <bit>

namespace engram::world {
namespace {

constexpr unsigned kLargestTexture = 2048;

int powerOfTwo(int side) {
  return static_cast<int>(std::min(kLargestTexture, std::bit_ceil(static_cast<unsigned>(side))));
}

// The mean of the light, not of the bytes, of a 2 x 2 block (2 x 1 where one side has shrunk to a pixel).
std::uint32_t meanPixel(const std::vector<std::uint32_t>& fine, int width, int x0, int x1, int y0, int y1) {
  std::uint32_t out = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    float sum = 0;
    for (const int y : {y0, y1})
      for (const int x : {x0, x1}) {
        const auto v = static_cast<float>((fine[static_cast<std::size_t>(y) * width + x] >> shift) & 255);
        sum += v * v;
      }
    out |= static_cast<std::uint32_t>(std::sqrt(sum / 4) + 0.5f) << shift;
  }
  return out;
}

}  // namespace

Texture::Texture(const cv::Mat& image) {
  if (image.empty() || image.type() != CV_8UC3) throw base::Error("a texture must be an 8 bit colour image");
  cv::Mat full = image;
  const cv::Size size(powerOfTwo(image.cols), powerOfTwo(image.rows));
  if (size != image.size())
    cv::resize(image, full, size, 0, 0,
               size.area() < image.size().area() ? cv::INTER_AREA : cv::INTER_LINEAR);
  Level level{full.cols, full.rows, std::countr_zero(static_cast<unsigned>(full.cols)), {}};
  level.pixels.reserve(full.total());
  for (int y = 0; y < full.rows; ++y)
    for (int x = 0; x < full.cols; ++x) {
      const auto& p = full.at<cv::Vec3b>(y, x);
      level.pixels.push_back(p[0] | (p[1] << 8) | (p[2] << 16));
    }
  levels_.push_back(std::move(level));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), std::max(0, fine.shift - 1), {}};
    coarse.pixels.reserve(static_cast<std::size_t>(coarse.width) * coarse.height);
    const int dx = fine.width > 1 ? 1 : 0, dy = fine.height > 1 ? 1 : 0;
    for (int y = 0; y < coarse.height; ++y)
      for (int x = 0; x < coarse.width; ++x)
        coarse.pixels.push_back(
            meanPixel(fine.pixels, fine.width, x << dx, (x << dx) + dx, y << dy, (y << dy) + dy));
    levels_.push_back(std::move(coarse));
  }
}

}  // namespace engram::world

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_images.h"

#include "engram/base/rng.h"

#include <opencv2/imgproc.hpp>

#include <stdexcept>
#include <utility>

namespace engram::apps {
namespace {

/// The part of an image that is looked at, as shares of its sides.
struct Window {
  double left, top, size;
};

Window windowOf(base::Rng& rng) {
  const double size = rng.uniform(0.6, 0.8);
  return {rng.uniform(0.05, 0.95 - size), rng.uniform(0.05, 0.95 - size), size};
}

Window besideIt(const Window& window, base::Rng& rng) {
  return {window.left + rng.uniform(-0.03, 0.03), window.top + rng.uniform(-0.03, 0.03),
          window.size * rng.uniform(0.96, 1.04)};
}

cv::Mat cut(const cv::Mat& image, const Window& window, cv::Size size) {
  const cv::Rect part(cvRound(window.left * image.cols), cvRound(window.top * image.rows),
                      cvRound(window.size * image.cols), cvRound(window.size * image.rows));
  cv::Mat out;
  cv::resize(image(part & cv::Rect({}, image.size())), out, size, 0, 0, cv::INTER_LINEAR);
  return out;
}

cv::Mat lit(const cv::Mat& image, base::Rng& rng) {
  cv::Mat out, noise(image.size(), CV_MAKETYPE(CV_16S, image.channels()));
  cv::RNG(rng.bits()).fill(noise, cv::RNG::NORMAL, 0.0, rng.uniform(2, 6));
  image.convertTo(out, CV_16S, rng.uniform(0.75, 1.25), rng.uniform(-15, 15));
  out += noise;
  out.convertTo(out, CV_8U);
  return out;
}

}  // namespace

BenchImages::BenchImages(std::vector<cv::Mat> images, std::uint64_t seed)
    : images_(std::move(images)), seed_(seed) {
  if (images_.empty()) throw std::invalid_argument("BenchImages: no images");
}

cv::Mat BenchImages::place(std::size_t i) const { return seen(i, false); }
cv::Mat BenchImages::query(std::size_t i) const { return seen(i, true); }

/// The first eight rounds through the images differ by turns and reflection, later ones by the window alone.
cv::Mat BenchImages::seen(std::size_t i, bool again) const {
  const cv::Mat& image = images_[i % images_.size()];
  const std::size_t round = i / images_.size();
  base::Rng rng = base::Rng(seed_).fork(i);
  Window window = windowOf(rng);
  base::Rng light = rng.fork(again ? 1 : 0);
  if (again) window = besideIt(window, light);
  cv::Mat mirrored, turned;
  if (round % 8 >= 4) cv::flip(image, mirrored, 1);
  const cv::Mat& upright = mirrored.empty() ? image : mirrored;
  if (round % 4 > 0) cv::rotate(upright, turned, static_cast<int>(round % 4 - 1));
  return lit(cut(turned.empty() ? upright : turned, window, image.size()), light);
}

}  // namespace engram::apps

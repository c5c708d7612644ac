// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paint.h"

#include <opencv2/imgproc.hpp>

#include <cmath>

namespace engram::world::paint {
namespace {

constexpr int kWidth = 2048, kHeight = 256, kHorizon = 176, kGround = 192;  // [px]; 8 px a metre upwards

void sky(cv::Mat& image, Rng rng) {
  const cv::Mat1f clouds = noise(kWidth, kHeight, 24, 5, rng);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double cover = std::clamp(0.35 + 0.9 * clouds(y, x), 0.0, 1.0);
      const Paint blue = mix({225, 170, 110}, {240, 225, 200}, static_cast<double>(y) / kHorizon);
      const Paint c = mix(blue, {250, 250, 248}, cover);
      image.at<cv::Vec3b>(y, x) =
          cv::Vec3b(cv::saturate_cast<std::uint8_t>(c[0]), cv::saturate_cast<std::uint8_t>(c[1]),
                    cv::saturate_cast<std::uint8_t>(c[2]));
    }
}

void house(cv::Mat& image, int x, Rng& rng) {
  const int w = pick(rng, 70, 190), top = pick(rng, 50, 140);
  const Paint wall = mix({120, 150, 185}, randomPaint(rng, 90, 220), 0.5);
  cv::rectangle(image, {x, top}, {x + w, kGround}, wall, cv::FILLED);
  const cv::Point roof[3]{{x - 5, top}, {x + w + 5, top}, {x + w / 2, top - pick(rng, 8, 40)}};
  cv::fillConvexPoly(image, roof, 3, mix({50, 60, 120}, {70, 70, 75}, rng.uniform()), cv::LINE_AA);
  for (int y = top + 8; y < kGround - 18; y += 26)
    for (int u = x + 8; u < x + w - 14; u += 24) {
      cv::rectangle(image, {u, y}, {u + 12, y + 15}, {110, 85, 65}, cv::FILLED);
      cv::rectangle(image, {u, y}, {u + 12, y + 15}, {225, 228, 230}, 2);
    }
}

void tree(cv::Mat& image, int x, int season, Rng& rng) {
  const int height = pick(rng, 50, 120), radius = height / 3;
  cv::line(image, {x, kGround + 4}, {x, kGround - height}, {35, 50, 65}, 6, cv::LINE_AA);
  const Paint leaves[]{{235, 235, 235}, {70, 190, 120}, {35, 120, 40}, {30, 110, 200}};
  const int count = season == 0 ? 60 : 130;
  for (int i = 0; i < count; ++i) {
    const double angle = rng.uniform(0, 6.283), r = radius * std::sqrt(rng.uniform());
    const cv::Point p(x + static_cast<int>(r * std::cos(angle)),
                      kGround - height + static_cast<int>(r * std::sin(angle)));
    if (season == 0)
      cv::line(image, {x, kGround - height * 2 / 3}, p, {55, 65, 75}, 1, cv::LINE_AA);
    else
      cv::circle(image, p, pick(rng, 3, 7), leaves[season] * rng.uniform(0.6, 1.15), cv::FILLED, cv::LINE_AA);
  }
}

}  // namespace

cv::Mat outside(Rng rng, int season) {
  cv::Mat image(kHeight, kWidth, CV_8UC3);
  sky(image, rng.fork(static_cast<std::uint64_t>(10 + season)));
  Rng houses = rng.fork(1), trees = rng.fork(2);  // the same in every season
  for (int x = 10; x < kWidth - 200; x += pick(houses, 90, 260)) house(image, x, houses);
  const Paint ground[]{{230, 232, 232}, {70, 150, 95}, {55, 140, 110}, {60, 120, 130}};
  cv::rectangle(image, {0, kGround}, {kWidth, kHeight}, ground[season], cv::FILLED);
  cv::rectangle(image, {0, kGround + 22}, {kWidth, kGround + 40}, {95, 95, 95}, cv::FILLED);
  for (int x = 0; x < kWidth; x += 48)
    cv::rectangle(image, {x, kGround + 30}, {x + 20, kGround + 32}, {210, 210, 210}, cv::FILLED);
  for (int x = 30; x < kWidth - 30; x += pick(trees, 50, 150)) {
    Rng one = trees.fork(static_cast<std::uint64_t>(x));
    tree(image, x, season, one);
  }
  for (int i = 0; i < 14; ++i) {  // parked cars
    const int x = pick(rng, 10, kWidth - 80);
    const Paint c = randomPaint(rng, 20, 220);
    cv::rectangle(image, {x, kGround + 10}, {x + 52, kGround + 24}, c, cv::FILLED);
    cv::rectangle(image, {x + 10, kGround}, {x + 40, kGround + 10}, c * 0.6, cv::FILLED);
    for (const int w : {12, 42}) cv::circle(image, {x + w, kGround + 25}, 5, {20, 20, 20}, cv::FILLED);
  }
  return image;
}

}  // namespace engram::world::paint

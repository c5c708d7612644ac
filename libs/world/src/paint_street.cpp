// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paint.h"

#include <opencv2/imgproc.hpp>

namespace engram::world::paint {
namespace {

constexpr int kTile = 512;         // [px] of a tile
constexpr int kMetre = kTile / 4;  // [px]
const Paint kGlass{95, 80, 65}, kSky{225, 205, 180};

void slab(cv::Mat& image, int x, int y, int w, int h, const Paint& colour, int thickness = cv::FILLED) {
  cv::rectangle(image, cv::Rect(x, y, w, h), colour, thickness);
}

/// Bricks or plaster of a 2 m tile, twice each way.
cv::Mat wallOf(Rng& rng, const Paint& colour) {
  cv::Mat small = rng.below(2) ? brick(rng.fork(1)) : plaster(rng.fork(1), colour), image;
  if (rng.below(2)) cv::addWeighted(small, 0.6, cv::Mat(small.size(), CV_8UC3, colour), 0.4, 0, small);
  cv::resize(small, small, {kTile / 2, kTile / 2}, 0, 0, cv::INTER_AREA);
  cv::repeat(small, 2, 2, image);
  return image;
}

/// A pane that shows the sky, or a curtain behind it.
void pane(cv::Mat& image, const cv::Rect& at, Rng& rng) {
  slab(image, at.x, at.y, at.width, at.height, mix(kGlass, kSky, 0.35 * rng.uniform()));
  const int slope = pick(rng, -at.width / 3, at.width / 3);
  cv::line(image, {at.x + at.width / 2 - slope, at.y + at.height - 2},
           {at.x + at.width / 2 + slope, at.y + 2}, mix(kGlass, kSky, 0.6), 3, cv::LINE_AA);
  if (rng.below(2)) slab(image, at.x, at.y, at.width / 4, at.height, randomPaint(rng, 110, 230));
  if (rng.below(2))
    slab(image, at.x, at.y, at.width, at.height / pick(rng, 4, 8), randomPaint(rng, 110, 230));
}

void window(cv::Mat& image, int x, int y, int w, int h, const Paint& frame, Rng& rng) {
  slab(image, x - 6, y - 6, w + 12, h + 12, frame);
  const int columns = 2, rows = pick(rng, 1, 2);
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r)
      pane(image, {x + c * w / columns + 2, y + r * h / rows + 2, w / columns - 4, h / rows - 4}, rng);
  slab(image, x - 12, y + h + 6, w + 24, 9, mix(frame, {150, 155, 160}, 0.6));
}

}  // namespace

cv::Mat facade(Rng rng, const Paint& colour) {
  cv::Mat image = wallOf(rng, colour);
  const Paint frame = mix(randomPaint(rng, 40, 240), {235, 235, 235}, rng.uniform());
  const int count = pick(rng, 1, 2), w = pick(rng, 100, count == 1 ? 230 : 140), h = pick(rng, 150, 210);
  for (int i = 0; i < count; ++i) {
    const int x = (2 * i + 1) * kTile / (2 * count) - w / 2 + pick(rng, -12, 12);
    window(image, x, kTile - kMetre - h, w, h, frame, rng);
  }
  const Paint ledge = mix(colour, {200, 205, 205}, rng.uniform());
  slab(image, 0, 0, kTile, pick(rng, 10, 26), ledge);
  for (int x = pick(rng, 8, 40); rng.below(3) && x < kTile; x += pick(rng, 30, 90))
    slab(image, x, 0, pick(rng, 6, 14), pick(rng, 14, 34), ledge * 0.8);
  return image;
}

cv::Mat street(Rng rng, int kind) {
  const Paint greys[]{{95, 95, 98}, {120, 125, 130}, {150, 155, 158}, {105, 112, 125}};
  const Paint grey = greys[kind % 4];
  cv::Mat image = plaster(rng.fork(1), grey);
  const int columns = kind % 4 == 1 ? 32 : 8, rows = kind % 4 == 1 ? 32 : 6;
  if (kind % 4 > 0)  // cobbles and slabs
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        slab(image, c * kTile / columns, r * kTile / rows, kTile / columns, kTile / rows,
             grey * rng.uniform(0.75, 1.2));
  if (kind % 4 > 0)
    for (int k = 0; k < std::max(columns, rows); ++k) {
      cv::line(image, {k * kTile / columns, 0}, {k * kTile / columns, kTile}, grey * 0.55, 2);
      cv::line(image, {0, k * kTile / rows}, {kTile, k * kTile / rows}, grey * 0.55, 2);
    }
  for (int i = 0; i < 40; ++i)  // patches, chewing gum, leaves
    cv::circle(image, {pick(rng, 0, kTile), pick(rng, 0, kTile)}, pick(rng, 2, 7),
               grey * rng.uniform(0.55, 1.45), cv::FILLED, cv::LINE_AA);
  if (kind % 4 == 0)
    for (int i = 0; i < 5; ++i)
      slab(image, pick(rng, 0, kTile - 90), pick(rng, 0, kTile - 60), pick(rng, 30, 90), pick(rng, 20, 60),
           grey * rng.uniform(0.7, 1.2));
  const cv::Mat1f wear = noise(kTile, kTile, 40, 3, rng.fork(2));
  for (int y = 0; y < kTile; ++y)
    for (int x = 0; x < kTile; ++x)
      for (int c = 0; c < 3; ++c)
        image.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<std::uint8_t>(image.at<cv::Vec3b>(y, x)[c] * (1 + 0.14f * wear(y, x)));
  return image;
}

cv::Mat shopFront(Rng rng) {
  const Paint frame = randomPaint(rng, 30, 170), sign = randomPaint(rng, 30, 230);
  cv::Mat image(kTile, kTile, CV_8UC3, frame);
  slab(image, 14, 14, kTile - 28, 90, sign);
  scribble(image, {30, 24, kTile - 60, 70}, 60, mix(sign, {255, 255, 255}, sign[1] < 130 ? 0.9 : -0.7), rng);
  slab(image, 20, 120, kTile - 40, kTile - 150, mix(kGlass, kSky, 0.25));
  for (int i = 0; i < 26; ++i) {  // goods
    const int w = pick(rng, 18, 80), h = pick(rng, 24, 120), x = pick(rng, 24, kTile - 30 - w);
    slab(image, x, kTile - 40 - h - (rng.below(2) ? 150 : 0), w, h, randomPaint(rng, 30, 240));
  }
  slab(image, 20, kTile - 190, kTile - 40, 6, frame * 1.3);
  const int middle = pick(rng, kTile / 3, 2 * kTile / 3);
  slab(image, middle, 120, 8, kTile - 150, frame);
  cv::line(image, {60, kTile - 60}, {180, 140}, mix(kGlass, kSky, 0.7), 5, cv::LINE_AA);
  return image;
}

}  // namespace engram::world::paint

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paint.h"

#include <opencv2/imgproc.hpp>

#include <cmath>
#include <numbers>

namespace engram::world::paint {
namespace {

constexpr int kSide = 512;  // [px] of tiling textures

std::uint8_t byteOf(double v) { return static_cast<std::uint8_t>(v < 0 ? 0 : v > 255 ? 255 : v + 0.5); }

// colour * (1 + strength * field), pixel by pixel
void modulate(cv::Mat& image, const cv::Mat1f& field, float strength) {
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      auto& p = image.at<cv::Vec3b>(y, x);
      const float k = 1 + strength * field(y % field.rows, x % field.cols);
      for (int c = 0; c < 3; ++c) p[c] = byteOf(p[c] * k);
    }
}

void speckle(cv::Mat& image, double strength, Rng& rng) {
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const double k = 1 + strength * (rng.uniform() - 0.5);
      for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = byteOf(image.at<cv::Vec3b>(y, x)[c] * k);
    }
}

void addOctave(cv::Mat1f& out, int nx, int ny, float gain, Rng& rng) {
  std::vector<float> lattice(static_cast<std::size_t>(nx) * ny);
  for (auto& v : lattice) v = static_cast<float>(rng.uniform(-1, 1));
  const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
  for (int y = 0; y < out.rows; ++y) {
    const float fy = static_cast<float>(y) * ny / out.rows;
    const int y0 = static_cast<int>(fy), y1 = (y0 + 1) % ny;
    const float ty = smooth(fy - static_cast<float>(y0));
    for (int x = 0; x < out.cols; ++x) {
      const float fx = static_cast<float>(x) * nx / out.cols;
      const int x0 = static_cast<int>(fx), x1 = (x0 + 1) % nx;
      const float tx = smooth(fx - static_cast<float>(x0));
      const float a = lattice[y0 * nx + x0] * (1 - tx) + lattice[y0 * nx + x1] * tx;
      const float b = lattice[y1 * nx + x0] * (1 - tx) + lattice[y1 * nx + x1] * tx;
      out(y, x) += gain * (a * (1 - ty) + b * ty);
    }
  }
}

cv::Mat flat(const Paint& colour, int width = kSide, int height = kSide) {
  return cv::Mat(height, width, CV_8UC3, colour);
}

// Rows of blocks with joints; odd rows are shifted by half a block.
cv::Mat blocks(Rng& rng, int columns, int rows, double shift, int joint, const Paint& mortar,
               const Paint& base, double variation) {
  cv::Mat image = flat(mortar);
  const double w = static_cast<double>(kSide) / columns, h = static_cast<double>(kSide) / rows;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const Paint colour = base * (1 + variation * (rng.uniform() - 0.5));
      const double x = c * w + (r % 2) * shift * w;
      for (const double x0 : {x, x - kSide})
        cv::rectangle(image, cv::Point(static_cast<int>(x0) + joint, static_cast<int>(r * h) + joint),
                      cv::Point(static_cast<int>(x0 + w) - 1, static_cast<int>((r + 1) * h) - 1), colour,
                      cv::FILLED);
    }
  return image;
}

}  // namespace

cv::Mat1f noise(int width, int height, int cells, int octaves, Rng rng) {
  cv::Mat1f out(height, width, 0.0f);
  float gain = 1, total = 0;
  for (int o = 0; o < octaves; ++o) {
    const int n = std::min(cells << o, width), m = std::max(1, n * height / width);
    addOctave(out, n, m, gain, rng);
    total += gain;
    gain *= 0.6f;
  }
  return cv::Mat1f(out * (1.6f / total));
}

Paint randomPaint(Rng& rng, double low, double high) {
  const double b = rng.uniform(low, high), g = rng.uniform(low, high), r = rng.uniform(low, high);
  return {b, g, r};
}

Paint mix(const Paint& a, const Paint& b, double share) { return a * (1 - share) + b * share; }

cv::Mat plaster(Rng rng, const Paint& colour) {
  cv::Mat image = flat(colour);
  modulate(image, noise(kSide, kSide, 4, 6, rng.fork(1)), 0.07f);
  modulate(image, noise(kSide, kSide, 96, 2, rng.fork(2)), 0.05f);
  for (int i = 0; i < 14; ++i) {  // scuffs and nail holes
    const cv::Point p(static_cast<int>(rng.below(kSide)), static_cast<int>(rng.below(kSide)));
    const Paint dark = colour * rng.uniform(0.6, 0.9);
    if (i % 2)
      cv::circle(image, p, 1 + static_cast<int>(rng.below(3)), dark, cv::FILLED, cv::LINE_AA);
    else
      cv::line(image, p,
               p + cv::Point(static_cast<int>(rng.below(30)) - 15, static_cast<int>(rng.below(20)) - 10),
               dark, 1, cv::LINE_AA);
  }
  return image;
}

cv::Mat brick(Rng rng) {
  const Paint base = mix({60, 75, 140}, {90, 120, 165}, rng.uniform());
  cv::Mat image = blocks(rng, 8, 24, 0.5, 4, {160, 170, 175}, base, 0.5);
  modulate(image, noise(kSide, kSide, 32, 4, rng.fork(1)), 0.16f);
  speckle(image, 0.12, rng);
  return image;
}

cv::Mat wallTiles(Rng rng, const Paint& colour) {
  cv::Mat image = blocks(rng, 10, 10, 0, 3, {150, 155, 155}, colour, 0.08);
  for (int i = 0; i < 6; ++i) {  // a few decorated ones
    const int x = static_cast<int>(rng.below(10)) * kSide / 10,
              y = static_cast<int>(rng.below(10)) * kSide / 10;
    cv::circle(image, {x + 26, y + 26}, 8 + static_cast<int>(rng.below(10)), randomPaint(rng, 60, 190),
               cv::FILLED, cv::LINE_AA);
  }
  modulate(image, noise(kSide, kSide, 6, 4, rng.fork(1)), 0.05f);
  return image;
}

cv::Mat wood(Rng rng, const Paint& colour) {
  cv::Mat image = flat(colour, 256, 256);
  const cv::Mat1f warp = noise(256, 256, 3, 4, rng.fork(1)), fine = noise(256, 256, 64, 2, rng.fork(2));
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) {
      const double rings = std::sin(2 * std::numbers::pi * (y / 32.0 + 1.2 * warp(y, x)));
      const double k = 1 + 0.14 * rings + 0.10 * fine(y, (x / 6) % 256);
      for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = byteOf(colour[c] * k);
    }
  return image;
}

cv::Mat panelling(Rng rng) {
  cv::Mat image = flat({70, 110, 150});
  constexpr int boards = 10;
  for (int i = 0; i < boards; ++i) {
    cv::Mat board;
    const Paint colour = Paint(75, 115, 160) * rng.uniform(0.75, 1.1);
    cv::rotate(wood(rng.fork(static_cast<std::uint64_t>(i)), colour), board, cv::ROTATE_90_CLOCKWISE);
    cv::resize(board, board, {kSide / boards - 2, kSide});
    board.copyTo(image(cv::Rect(i * kSide / boards, 0, board.cols, kSide)));
    cv::line(image, {i * kSide / boards, 0}, {i * kSide / boards, kSide}, {25, 40, 60}, 2);
  }
  return image;
}

cv::Mat carpet(Rng rng, const Paint& colour) {
  cv::Mat image = flat(colour);
  const Paint other = mix(colour, randomPaint(rng, 40, 200), 0.35);
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      const cv::Point p(i * 64 + 32, j * 64 + 32);
      const auto kind = rng.below(4);
      if (kind == 0) cv::circle(image, p, 12, other, 3, cv::LINE_AA);
      if (kind == 1) cv::rectangle(image, p - cv::Point(10, 10), p + cv::Point(10, 10), other, cv::FILLED);
      if (kind == 2) cv::line(image, p - cv::Point(20, 20), p + cv::Point(20, 20), other, 4, cv::LINE_AA);
    }
  modulate(image, noise(kSide, kSide, 5, 5, rng.fork(1)), 0.14f);
  speckle(image, 0.35, rng);
  return image;
}

cv::Mat parquet(Rng rng) {
  cv::Mat image = flat({40, 60, 80});
  const cv::Mat grain = wood(rng.fork(1), {90, 140, 185});
  for (int r = 0; r < 8; ++r)
    for (int c = -1; c < 4; ++c) {
      const int x = c * 128 + (r % 2) * 64 + 1, y = r * 64 + 1;
      cv::Mat plank =
          grain(cv::Rect(static_cast<int>(rng.below(128)), static_cast<int>(rng.below(190)), 126, 62)) *
          rng.uniform(0.7, 1.1);
      const cv::Rect all(x, y, 126, 62), seen = all & cv::Rect(0, 0, kSide, kSide);
      if (seen.area() > 0) plank(seen - all.tl()).copyTo(image(seen));
    }
  return image;
}

cv::Mat linoleum(Rng rng, const Paint& colour) {
  cv::Mat image = flat(colour);
  modulate(image, noise(kSide, kSide, 8, 6, rng.fork(1)), 0.18f);
  for (int i = 0; i < 700; ++i)
    cv::ellipse(image, {static_cast<int>(rng.below(kSide)), static_cast<int>(rng.below(kSide))},
                {2 + static_cast<int>(rng.below(6)), 1 + static_cast<int>(rng.below(3))}, rng.uniform(0, 180),
                0, 360, mix(colour, randomPaint(rng, 30, 220), 0.4), cv::FILLED, cv::LINE_AA);
  return image;
}

cv::Mat floorTiles(Rng rng) {
  const Paint base = mix({170, 180, 185}, {100, 120, 150}, rng.uniform());
  cv::Mat image = blocks(rng, 6, 6, 0, 3, {90, 95, 100}, base, 0.22);
  modulate(image, noise(kSide, kSide, 12, 5, rng.fork(1)), 0.10f);
  speckle(image, 0.08, rng);
  return image;
}

cv::Mat ceiling(Rng rng) {
  cv::Mat image = blocks(rng, 4, 4, 0, 4, {150, 155, 155}, {222, 226, 226}, 0.05);
  for (int i = 0; i < 1100; ++i)
    cv::circle(image, {static_cast<int>(rng.below(kSide)), static_cast<int>(rng.below(kSide))}, 1,
               {150, 155, 158}, cv::FILLED);
  for (int i = 0; i < 3; ++i) {  // water stains
    const cv::Point p(static_cast<int>(rng.below(kSide)), static_cast<int>(rng.below(kSide)));
    cv::ellipse(image, p, {10 + static_cast<int>(rng.below(25)), 8 + static_cast<int>(rng.below(20))},
                rng.uniform(0, 90), 0, 360, {165, 190, 200}, 3, cv::LINE_AA);
  }
  return image;
}

cv::Mat fabric(Rng rng, const Paint& colour) {
  cv::Mat image = flat(colour, 128, 128);
  modulate(image, noise(128, 128, 4, 5, rng.fork(1)), 0.2f);
  for (int i = 0; i < 128; i += 16) cv::line(image, {i, 0}, {i, 127}, colour * 0.75, 2);
  speckle(image, 0.3, rng);
  return image;
}

cv::Mat foliage(Rng rng) {
  cv::Mat image = flat({20, 45, 25}, 256, 256);
  for (int i = 0; i < 350; ++i)
    cv::ellipse(
        image, {static_cast<int>(rng.below(256)), static_cast<int>(rng.below(256))},
        {6 + static_cast<int>(rng.below(14)), 3 + static_cast<int>(rng.below(4))}, rng.uniform(0, 180), 0,
        360, Paint(rng.uniform(20, 70), rng.uniform(70, 190), rng.uniform(20, 90)), cv::FILLED, cv::LINE_AA);
  return image;
}

cv::Mat grime(Rng rng) {
  cv::Mat image = flat({128, 128, 128});
  modulate(image, noise(kSide, kSide, 16, 5, rng.fork(1)), 0.10f);
  for (int i = 0; i < 420; ++i) {
    const cv::Point p(static_cast<int>(rng.below(kSide)), static_cast<int>(rng.below(kSide)));
    const Paint tone = Paint(1, 1, 1) * rng.uniform(85, 120);
    if (i % 3 == 0)
      cv::line(image, p,
               p + cv::Point(static_cast<int>(rng.below(24)) - 12, static_cast<int>(rng.below(10)) - 5), tone,
               1, cv::LINE_AA);
    else
      cv::ellipse(image, p, {1 + static_cast<int>(rng.below(4)), 1 + static_cast<int>(rng.below(3))},
                  rng.uniform(0, 180), 0, 360, tone, cv::FILLED, cv::LINE_AA);
  }
  return image;
}

}  // namespace engram::world::paint

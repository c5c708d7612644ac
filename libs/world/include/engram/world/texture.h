// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace engram::world {

/// Linear light or reflectance as (b, g, r, unused); four floats for the sake of vector instructions.
using Colour = Eigen::Array4f;
inline Colour bgr(float b, float g, float r) { return {b, g, r, 0.0f}; }

/// An image with its mipmaps. Pixels are stored with gamma 2: reflectance = (byte / 255)^2, which is also the
/// tone curve of the simulated sensor, so a texture looks on the picture as in its file.
class Texture {
 public:
  Texture() = default;
  /// @param image 8 bit BGR; it is resized so that the sides are powers of two.
  explicit Texture(const cv::Mat& image);

  /// Reflectance at (u, v) in [0, 1) from the top left corner; beyond, the texture repeats.
  /// @param level mipmap level, 0 is the full size.
  Colour sample(float u, float v, int level) const {
    const Level& l = levels_[std::clamp(level, 0, static_cast<int>(levels_.size()) - 1)];
    const float x = u * static_cast<float>(l.width) - 0.5f, y = v * static_cast<float>(l.height) - 0.5f;
    const int x0 = floorInt(x), y0 = floorInt(y);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const std::uint32_t* a = &l.pixels[static_cast<std::size_t>(y0 & (l.height - 1)) << l.shift];
    const std::uint32_t* b = &l.pixels[static_cast<std::size_t>((y0 + 1) & (l.height - 1)) << l.shift];
    const int i = x0 & (l.width - 1), j = (x0 + 1) & (l.width - 1);
    const Colour c = (decode(a[i]) * (1 - fx) + decode(a[j]) * fx) * (1 - fy) +
                     (decode(b[i]) * (1 - fx) + decode(b[j]) * fx) * fy;
    return c * c;
  }

  bool empty() const { return levels_.empty(); }
  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  int levels() const { return static_cast<int>(levels_.size()); }

 private:
  struct Level {
    int width = 0, height = 0, shift = 0;  // width = 1 << shift
    std::vector<std::uint32_t> pixels;     // B, G, R from the low byte
  };
  static int floorInt(float v) {
    const int i = static_cast<int>(v);
    return i - (static_cast<float>(i) > v);
  }
  static Colour decode(std::uint32_t p) {
    constexpr float k = 1.0f / 255.0f;
#ifdef __SSE2__
    const __m128i zero = _mm_setzero_si128();
    const __m128i wide = _mm_unpacklo_epi8(_mm_cvtsi32_si128(static_cast<int>(p)), zero);
    alignas(16) float channels[4];
    _mm_store_ps(channels, _mm_mul_ps(_mm_cvtepi32_ps(_mm_unpacklo_epi16(wide, zero)), _mm_set1_ps(k)));
    return Eigen::Map<const Colour, Eigen::Aligned16>(channels);
#else
    return Colour(static_cast<float>(p & 255), static_cast<float>((p >> 8) & 255),
                  static_cast<float>((p >> 16) & 255), 0.0f) *
           k;
#endif
  }

  std::vector<Level> levels_;
};

/// The textures of a scene by number.
class TextureAtlas {
 public:
  int add(const cv::Mat& image) {
    textures_.emplace_back(image);
    return static_cast<int>(textures_.size()) - 1;
  }
  const Texture& operator[](int i) const { return textures_[static_cast<std::size_t>(i)]; }
  std::size_t size() const { return textures_.size(); }

 private:
  std::vector<Texture> textures_;
};

}  // namespace engram::world

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace engram::base {

/// Larger images are refused before they are decoded: a file of some kilobytes can expand to gigabytes. No
/// camera of a robot has 67 million pixels; as colours they take 200 MB.
inline constexpr int kMaxImageSide = 1 << 15;
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 26;
bool plausibleSize(std::int64_t width, std::int64_t height);
/// "30000x30000 pixels; at most 32768 a side and 67108864 in all can be used"
std::string sizeRefusal(std::int64_t width, std::int64_t height);

struct ImageSize {
  std::int64_t width = 0, height = 0;  ///< as stated, which may be nonsense
};

/// What the header of an image file (JPEG, PNG, BMP, PBM, PGM, PPM, TIFF, WebP) states, without decoding it;
/// none for anything else.
std::optional<ImageSize> sizeInHeader(std::span<const std::uint8_t> file);

/// Why an image file must not be decoded; empty when it may.
std::string imageRefusal(std::span<const std::uint8_t> file);

/// An image file that may be decoded. Throws base::Error when it cannot be read or imageRefusal() says why.
std::vector<std::uint8_t> readImageBytes(const std::string& path);

}  // namespace engram::base

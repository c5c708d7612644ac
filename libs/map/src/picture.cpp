// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/picture.h"

namespace engram::map {
namespace {

constexpr std::uint32_t kMostPixels = 1 << 24;

/// Markers without a length: fill bytes, TEM, RST0 to RST7.
bool standsAlone(std::uint8_t marker) {
  return marker == 0xff || marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7);
}

/// SOF0 to SOF15, among which DHT, JPG and DAC stand.
bool beginsFrame(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

}  // namespace

std::string brokenPicture(std::span<const std::uint8_t> jpeg) {
  const auto number = [&](std::size_t at) { return std::uint32_t{jpeg[at]} << 8 | jpeg[at + 1]; };
  if (jpeg.size() < 4 || number(0) != 0xffd8) return "it is not a JPEG";
  for (std::size_t at = 2; at + 9 <= jpeg.size() && jpeg[at] == 0xff;) {
    const std::uint8_t marker = jpeg[at + 1];
    if (standsAlone(marker)) {
      at += marker == 0xff ? 1 : 2;
      continue;
    }
    if (beginsFrame(marker)) {
      const std::uint32_t pixels = number(at + 5) * number(at + 7);
      if (pixels == 0) return "it has no pixels";
      return pixels <= kMostPixels ? "" : "it has too many pixels";
    }
    if (marker == 0xd9 || marker == 0xda) break;  // the end, or pixels, before any size
    at += 2 + number(at + 2);
  }
  return "its header is damaged";
}

}  // namespace engram::map

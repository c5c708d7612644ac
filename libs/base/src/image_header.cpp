// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/image_header.h"

#include "engram/base/error.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace engram::base {
namespace {

using Bytes = std::span<const std::uint8_t>;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 29;

/// Numbers of either order of bytes; what lies beyond the end is 0, which is no size.
struct Reader {
  Bytes bytes;
  bool bigEndian = true;

  std::int64_t at(std::size_t offset, std::size_t n) const {
    if (offset > bytes.size() || bytes.size() - offset < n) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < n; ++i)
      value |= std::uint64_t{bytes[offset + i]} << 8 * (bigEndian ? n - 1 - i : i);
    return static_cast<std::int64_t>(value);
  }
};

bool beginsWith(Bytes bytes, std::string_view text, std::size_t offset = 0) {
  return bytes.size() >= offset + text.size() &&
         std::equal(text.begin(), text.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

/// The frame header (SOF0 to SOF15 but for the tables between them) behind the segments before it.
std::optional<ImageSize> ofJpeg(Bytes file) {
  const Reader in{file};
  std::size_t at = 2;
  while (at + 9 <= file.size()) {
    if (file[at] != 0xFF || file[at + 1] == 0xFF || file[at + 1] == 0) {
      ++at;  // cameras leave bytes between segments
      continue;
    }
    const int marker = file[at + 1];
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC)
      return ImageSize{in.at(at + 7, 2), in.at(at + 5, 2)};
    const bool alone = marker == 0x01 || (marker >= 0xD0 && marker <= 0xD9);
    at += alone ? 2 : 2 + static_cast<std::size_t>(in.at(at + 2, 2));
  }
  return std::nullopt;
}

ImageSize ofBmp(Bytes file) {
  const Reader in{file, false};
  if (in.at(14, 4) == 12) return {in.at(18, 2), in.at(20, 2)};
  const auto height = static_cast<std::int32_t>(in.at(22, 4));  // negative: the first row is the top one
  return {static_cast<std::int32_t>(in.at(18, 4)), height < 0 ? -std::int64_t{height} : height};
}

ImageSize ofPnm(Bytes file) {
  std::size_t at = 2;
  const auto number = [&]() -> std::int64_t {
    while (at < file.size() && (std::isspace(file[at]) != 0 || file[at] == '#'))
      if (file[at++] == '#')
        while (at < file.size() && file[at] != '\n') ++at;
    std::int64_t value = 0;
    for (; at < file.size() && std::isdigit(file[at]) != 0; ++at)
      value = std::min<std::int64_t>(value * 10 + file[at] - '0', std::int64_t{1} << 40);
    return value;
  };
  const std::int64_t width = number();
  return {width, number()};
}

ImageSize ofWebp(Bytes file) {
  const Reader in{file, false};
  if (beginsWith(file, "VP8X", 12)) return {in.at(24, 3) + 1, in.at(27, 3) + 1};
  if (beginsWith(file, "VP8L", 12)) {
    const std::int64_t bits = in.at(21, 4);
    return {(bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1};
  }
  return {in.at(26, 2) & 0x3FFF, in.at(28, 2) & 0x3FFF};
}

/// Of the first image; its tiles are allocated whole.
ImageSize ofTiff(Bytes file) {
  const Reader in{file, file[0] == 'M'};
  const bool big = in.at(2, 2) == 43;
  const auto directory = static_cast<std::size_t>(big ? in.at(8, 8) : in.at(4, 4));
  const std::size_t entry = big ? 20 : 12, first = directory + (big ? 8u : 2u);
  const std::int64_t entries = std::min<std::int64_t>(in.at(directory, big ? 8 : 2), 4096);
  ImageSize size;
  for (std::int64_t i = 0; i < entries; ++i) {
    const std::size_t at = first + static_cast<std::size_t>(i) * entry;
    const std::int64_t tag = in.at(at, 2), type = in.at(at + 2, 2);
    const std::int64_t value = in.at(at + (big ? 12u : 8u), type == 3 ? 2 : type == 16 ? 8 : 4);
    if (tag == 256 || tag == 322) size.width = std::max(size.width, value);
    if (tag == 257 || tag == 323) size.height = std::max(size.height, value);
  }
  return size;
}

}  // namespace

bool plausibleSize(std::int64_t width, std::int64_t height) {
  return width > 0 && height > 0 && width <= kMaxImageSide && height <= kMaxImageSide &&
         width * height <= kMaxImagePixels;
}

std::string sizeRefusal(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + "x" + std::to_string(height) + " pixels; at most " +
         std::to_string(kMaxImageSide) + " a side and " + std::to_string(kMaxImagePixels) +
         " in all can be used";
}

std::optional<ImageSize> sizeInHeader(Bytes file) {
  const Reader in{file};
  if (beginsWith(file, "\xFF\xD8")) return ofJpeg(file);
  if (beginsWith(file, "\x89PNG\r\n\x1A\n")) return ImageSize{in.at(16, 4), in.at(20, 4)};
  if (beginsWith(file, "BM")) return ofBmp(file);
  if (file.size() > 2 && file[0] == 'P' && file[1] >= '1' && file[1] <= '6') return ofPnm(file);
  if (beginsWith(file, "RIFF") && beginsWith(file, "WEBP", 8)) return ofWebp(file);
  if (beginsWith(file, "II") || beginsWith(file, "MM")) return ofTiff(file);
  return std::nullopt;
}

std::string imageRefusal(Bytes file) {
  if (file.empty()) return "the file is empty";
  const auto size = sizeInHeader(file);
  if (!size) return "not an image that can be decoded (JPEG, PNG, BMP, PBM, PGM, PPM, TIFF, WebP)";
  if (size->width <= 0 || size->height <= 0) return "not an image that can be decoded: its header is damaged";
  return plausibleSize(size->width, size->height) ? ""
                                                  : "the image has " + sizeRefusal(size->width, size->height);
}

std::vector<std::uint8_t> readImageBytes(const std::string& path) {
  std::error_code status;
  const auto size = std::filesystem::file_size(path, status);
  if (status) throw Error(path + ": cannot be read: " + status.message());
  if (size > kMostBytes) throw Error(path + ": is too large for an image");
  std::vector<std::uint8_t> bytes(size);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    throw Error(path + ": cannot be read");
  if (const std::string why = imageRefusal(bytes); !why.empty()) throw Error(path + ": " + why);
  return bytes;
}

}  // namespace engram::base

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pixel_format.h"

#include "engram/base/error.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstdio>

namespace engram::capture {
namespace {

struct Format {
  std::uint32_t pfnc;
  const char* name;
  int type;        ///< of the cv::Mat over the raw bytes
  int shift;       ///< bits to drop, for 16 bit containers
  int conversion;  ///< of cv::cvtColor; -1: none
};

// OpenCV names a Bayer pattern by the pixels (1,1) and (1,2), GenICam by (0,0) and (0,1): BayerRG is OpenCV's
// BG.
constexpr std::array kFormats = {
    Format{0x01080001, "Mono8", CV_8UC1, 0, -1},
    Format{0x01100003, "Mono10", CV_16UC1, 2, -1},
    Format{0x01100005, "Mono12", CV_16UC1, 4, -1},
    Format{0x01100007, "Mono16", CV_16UC1, 8, -1},
    Format{0x01080008, "BayerGR8", CV_8UC1, 0, cv::COLOR_BayerGB2BGR},
    Format{0x01080009, "BayerRG8", CV_8UC1, 0, cv::COLOR_BayerBG2BGR},
    Format{0x0108000A, "BayerGB8", CV_8UC1, 0, cv::COLOR_BayerGR2BGR},
    Format{0x0108000B, "BayerBG8", CV_8UC1, 0, cv::COLOR_BayerRG2BGR},
    Format{0x02180014, "RGB8", CV_8UC3, 0, cv::COLOR_RGB2BGR},
    Format{0x02180015, "BGR8", CV_8UC3, 0, -1},
};

const Format* find(std::uint32_t pfnc) {
  const auto at =
      std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& f) { return f.pfnc == pfnc; });
  return at == kFormats.end() ? nullptr : &*at;
}

/// GigE Vision sends 16 bit pixels with the low byte first, like the processors we run on.
cv::Mat withoutLowBits(const cv::Mat& deep, int shift) {
  cv::Mat image(deep.size(), CV_8UC1);
  for (int y = 0; y < deep.rows; ++y) {
    const auto* from = deep.ptr<std::uint16_t>(y);
    auto* to = image.ptr<std::uint8_t>(y);
    for (int x = 0; x < deep.cols; ++x) to[x] = static_cast<std::uint8_t>(std::min(from[x] >> shift, 255));
  }
  return image;
}

}  // namespace

int bitsPerPixel(std::uint32_t pfnc) { return static_cast<int>((pfnc >> 16) & 0xFF); }

bool isSupported(std::uint32_t pfnc) { return find(pfnc) != nullptr; }

std::string supportedFormats() {
  std::string names;
  for (const Format& f : kFormats) names += (names.empty() ? "" : ", ") + std::string(f.name);
  return names;
}

cv::Mat toImage(std::span<const std::uint8_t> bytes, cv::Size size, std::uint32_t pfnc, int rowPadding) {
  const Format* format = find(pfnc);
  if (!format) {
    char code[16];
    std::snprintf(code, sizeof code, "0x%08X", pfnc);
    throw base::Error("pixel format " + std::string(code) + " is not supported; set pixel_format to one of " +
                      supportedFormats());
  }
  const std::size_t row = static_cast<std::size_t>(size.width) * CV_ELEM_SIZE(format->type);
  const std::size_t step = row + static_cast<std::size_t>(rowPadding);
  if (size.empty() || bytes.size() < step * static_cast<std::size_t>(size.height - 1) + row)
    throw base::Error("an image of " + std::to_string(size.width) + "x" + std::to_string(size.height) + " " +
                      format->name + " does not fit in a buffer of " + std::to_string(bytes.size()) +
                      " bytes");
  const cv::Mat raw(size, format->type, const_cast<std::uint8_t*>(bytes.data()), step);
  if (format->shift > 0) return withoutLowBits(raw, format->shift);
  if (format->conversion < 0) return raw.clone();
  cv::Mat image;
  cv::cvtColor(raw, image, format->conversion);
  return image;
}

}  // namespace engram::capture

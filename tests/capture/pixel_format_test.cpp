// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pixel_format.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>

#include <arv.h>
#include <map>
#include <vector>

namespace engram::capture {
namespace {

using ::testing::HasSubstr;

cv::Mat convert(const std::vector<std::uint8_t>& bytes, int width, int height, std::uint32_t pfnc,
                int padding = 0) {
  return toImage(bytes, {width, height}, pfnc, padding);
}

TEST(PixelFormat, Mono8IsCopiedWithoutItsPadding) {
  const std::vector<std::uint8_t> bytes = {1, 2, 3, 99, 99, 4, 5, 6, 99, 99};
  const cv::Mat image = convert(bytes, 3, 2, ARV_PIXEL_FORMAT_MONO_8, 2);
  ASSERT_EQ(image.type(), CV_8UC1);
  EXPECT_TRUE(image.isContinuous());
  EXPECT_EQ(std::vector<std::uint8_t>(image.begin<std::uint8_t>(), image.end<std::uint8_t>()),
            (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6}));
}

TEST(PixelFormat, DeepFormatsLoseTheirLowestBits) {
  const std::map<std::uint32_t, int> bits = {
      {ARV_PIXEL_FORMAT_MONO_10, 10}, {ARV_PIXEL_FORMAT_MONO_12, 12}, {ARV_PIXEL_FORMAT_MONO_16, 16}};
  for (const auto& [format, n] : bits) {
    for (int value = 0; value < (1 << n); value += 7) {
      const cv::Mat image = convert(
          {static_cast<std::uint8_t>(value & 0xFF), static_cast<std::uint8_t>(value >> 8)}, 1, 1, format);
      ASSERT_EQ(image.type(), CV_8UC1);
      ASSERT_EQ(image.at<std::uint8_t>(0), value * 256 / (1 << n)) << n << " bits, " << value;
    }
  }
  EXPECT_EQ(convert({0xFF, 0xFF}, 1, 1, ARV_PIXEL_FORMAT_MONO_10).at<std::uint8_t>(0),
            255);  // stray high bits
}

TEST(PixelFormat, ColoursComeInTheOrderBlueGreenRed) {
  EXPECT_EQ(convert({10, 20, 30}, 1, 1, ARV_PIXEL_FORMAT_RGB_8_PACKED).at<cv::Vec3b>(0),
            cv::Vec3b(30, 20, 10));
  EXPECT_EQ(convert({10, 20, 30}, 1, 1, ARV_PIXEL_FORMAT_BGR_8_PACKED).at<cv::Vec3b>(0),
            cv::Vec3b(10, 20, 30));
}

/// A scene of one colour behind each of the four patterns: the colours of the pixels (0,0), (1,0), (0,1),
/// (1,1).
TEST(PixelFormat, EveryBayerPatternShowsTheTrueColour) {
  const std::map<std::uint32_t, std::string> patterns = {{ARV_PIXEL_FORMAT_BAYER_RG_8, "RGGB"},
                                                         {ARV_PIXEL_FORMAT_BAYER_BG_8, "BGGR"},
                                                         {ARV_PIXEL_FORMAT_BAYER_GR_8, "GRBG"},
                                                         {ARV_PIXEL_FORMAT_BAYER_GB_8, "GBRG"}};
  const std::map<char, std::uint8_t> colour = {{'R', 200}, {'G', 120}, {'B', 40}};
  constexpr int kSide = 8;
  for (const auto& [format, pattern] : patterns) {
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) bytes.push_back(colour.at(pattern[2 * (y % 2) + x % 2]));
    const cv::Mat image = convert(bytes, kSide, kSide, format);
    ASSERT_EQ(image.type(), CV_8UC3);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        ASSERT_EQ(image.at<cv::Vec3b>(y, x), cv::Vec3b(40, 120, 200)) << pattern << " " << x << "," << y;
  }
}

TEST(PixelFormat, NamesWhatItCannotRead) {
  EXPECT_FALSE(isSupported(ARV_PIXEL_FORMAT_YUV_422_PACKED));
  try {
    convert(std::vector<std::uint8_t>(100), 2, 2, ARV_PIXEL_FORMAT_YUV_422_PACKED);
    FAIL();
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("0x0210001F"));
    EXPECT_THAT(e.what(), HasSubstr("BayerRG8"));
  }
}

TEST(PixelFormat, RefusesABufferThatIsTooSmall) {
  for (const std::uint32_t format :
       {ARV_PIXEL_FORMAT_MONO_8, ARV_PIXEL_FORMAT_MONO_16, ARV_PIXEL_FORMAT_RGB_8_PACKED}) {
    ASSERT_TRUE(isSupported(format));
    const auto need = static_cast<std::size_t>(16 * bitsPerPixel(format) / 8);
    EXPECT_NO_THROW(convert(std::vector<std::uint8_t>(need), 4, 4, format));
    EXPECT_THROW(convert(std::vector<std::uint8_t>(need - 1), 4, 4, format), base::Error);
  }
  EXPECT_THROW(convert({}, 0, 0, ARV_PIXEL_FORMAT_MONO_8), base::Error);
}

}  // namespace
}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros_messages.h"

#include "engram/base/error.h"

#include <gmock/gmock.h>

namespace engram::bags {
namespace {

using ::testing::HasSubstr;

const BagTopic kRos1Image{"/image", "sensor_msgs/Image", false, 0};

void put(std::vector<std::uint8_t>& out, std::uint32_t n) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(n >> shift));
}
void put(std::vector<std::uint8_t>& out, const std::string& text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

/// sensor_msgs/Image as ROS 1 serialises it.
BagMessage imageMessage(const std::string& encoding, std::uint32_t width, std::uint32_t height,
                        std::uint32_t step, const std::string& pixels) {
  BagMessage message;
  for (const std::uint32_t n : {7u, 100u, 500000000u}) put(message.data, n);
  put(message.data, "/camera");
  put(message.data, height), put(message.data, width);
  put(message.data, encoding);
  message.data.push_back(0);
  put(message.data, step);
  put(message.data, pixels);
  return message;
}

/// An image of one colour, whose pixels repeat `pattern` along the rows; every second row repeats `odd`.
cv::Vec3b colourOf(const std::string& encoding, const std::string& even, const std::string& odd,
                   int channels) {
  std::string pixels;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8 * channels; ++x) {
      const std::string& row = y % 2 == 0 ? even : odd;
      pixels += row[static_cast<std::size_t>(x) % row.size()];
    }
  const auto image =
      readImage(imageMessage(encoding, 8, 8, static_cast<std::uint32_t>(8 * channels), pixels), kRos1Image);
  EXPECT_EQ(image.failure, "") << encoding;
  EXPECT_EQ(image.image.type(), CV_8UC3) << encoding;
  return image.image.empty() ? cv::Vec3b() : image.image.at<cv::Vec3b>(4, 4);
}

TEST(RosMessages, EncodingsBecomeTheColourThatWasSent) {
  const cv::Vec3b sent(50, 100, 200);  // blue, green, red
  const std::string bgr = "\x32\x64\xC8", rgb = "\xC8\x64\x32", rg = "\xC8\x64", gb = "\x64\x32",
                    bg = "\x32\x64", gr = "\x64\xC8";
  EXPECT_EQ(colourOf("bgr8", bgr, bgr, 3), sent);
  EXPECT_EQ(colourOf("rgb8", rgb, rgb, 3), sent);
  EXPECT_EQ(colourOf("bgra8", bgr + "\xFF", bgr + "\xFF", 4), sent);
  EXPECT_EQ(colourOf("rgba8", rgb + "\xFF", rgb + "\xFF", 4), sent);
  EXPECT_EQ(colourOf("bayer_rggb8", rg, gb, 1), sent);
  EXPECT_EQ(colourOf("bayer_bggr8", bg, gr, 1), sent);
  EXPECT_EQ(colourOf("bayer_gbrg8", gb, rg, 1), sent);
  EXPECT_EQ(colourOf("bayer_grbg8", gr, bg, 1), sent);
}

TEST(RosMessages, YuvWithoutColourIsGrey) {
  // BT.601: luminance 126 of 16 … 235 is grey 128.
  const std::string uyvy = "\x80\x7E", yuyv = "\x7E\x80";
  EXPECT_EQ(colourOf("yuv422", uyvy, uyvy, 2), cv::Vec3b(128, 128, 128));
  EXPECT_EQ(colourOf("yuv422_yuy2", yuyv, yuyv, 2), cv::Vec3b(128, 128, 128));
}

TEST(RosMessages, HeaderLosesItsSlash) {
  const auto header = readHeader(imageMessage("mono8", 1, 1, 1, "x"), kRos1Image);
  EXPECT_DOUBLE_EQ(header.stamp, 100.5);
  EXPECT_EQ(header.frame, "camera");
}

TEST(RosMessages, ImagesThatCannotBeUsedSayWhy) {
  const auto failure = [](const BagMessage& message) { return readImage(message, kRos1Image).failure; };
  EXPECT_THAT(failure(imageMessage("16UC1", 2, 1, 4, "abcd")), HasSubstr("16UC1"));
  EXPECT_THAT(failure(imageMessage("mono8", 4, 4, 4, "short")), HasSubstr("incomplete"));
  EXPECT_THAT(failure(imageMessage("mono8", 4, 1, 3, "abcd")), HasSubstr("incomplete"));
  EXPECT_THAT(failure(imageMessage("rgb8", 0xFFFFFFFF, 0xFFFFFFFF, 4, "abcd")), HasSubstr("at most"));
}

TEST(RosMessages, CdrOfTheOtherByteOrder) {
  // Header of 3.25 s in the frame "ab", big-endian; the zero at the end of the text is counted.
  BagMessage message;
  message.data = {0, 0, 0, 0, 0, 0, 0, 3, 0x0E, 0xE6, 0xB2, 0x80, 0, 0, 0, 3, 'a', 'b', 0};
  const auto header = readHeader(message, {"/image", "sensor_msgs/Image", true, 0});
  EXPECT_DOUBLE_EQ(header.stamp, 3.25);
  EXPECT_EQ(header.frame, "ab");
}

TEST(RosMessages, ThatAreTooShortAreRefused) {
  const auto whole = imageMessage("mono8", 2, 2, 2, "abcd");
  for (std::size_t n = 0; n < whole.data.size(); ++n) {
    BagMessage cut = whole;
    cut.data.resize(n);
    EXPECT_THROW(readImage(cut, kRos1Image), base::Error) << n;
  }
}

}  // namespace
}  // namespace engram::bags

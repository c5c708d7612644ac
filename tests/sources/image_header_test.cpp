// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/image_header.h"

#include "engram/base/error.h"
#include "engram/sources/image_folder_source.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <zlib.h>

namespace engram::sources::test {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<unsigned char>;

Bytes encoded(const std::string& extension, cv::Size size, const std::vector<int>& options = {}) {
  Bytes bytes;
  cv::imencode(extension, picture(1, size, extension == ".pgm" || extension == ".pbm" ? 1 : 3), bytes,
               options);
  return bytes;
}

void put(Bytes& bytes, std::size_t at, std::uint32_t value, bool bigEndian) {
  for (std::size_t i = 0; i < 4; ++i)
    bytes.at(at + i) = static_cast<unsigned char>(value >> 8 * (bigEndian ? 3 - i : i));
}

/// A sound PNG of few bytes but for the size that it states: a decoder would take gigabytes.
Bytes hugePng(std::uint32_t width, std::uint32_t height) {
  Bytes bytes = encoded(".png", {8, 8});
  put(bytes, 16, width, true);
  put(bytes, 20, height, true);
  put(bytes, 29, static_cast<std::uint32_t>(crc32(0, bytes.data() + 12, 17)), true);
  return bytes;
}

TEST(ImageHeader, StatesTheSizeOfWhatOpenCvWrites) {
  for (const char* extension : {".jpg", ".png", ".bmp", ".pgm", ".ppm", ".pbm", ".tif", ".webp"})
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(37, 300), cv::Size(641, 2)}) {
      const auto found = base::sizeInHeader(encoded(extension, size));
      ASSERT_TRUE(found) << extension;
      EXPECT_EQ(found->width, size.width) << extension;
      EXPECT_EQ(found->height, size.height) << extension;
      EXPECT_EQ(base::imageRefusal(encoded(extension, size)), "") << extension;
    }
}

TEST(ImageHeader, ReadsTheRarerForms) {
  const auto lossless = base::sizeInHeader(encoded(".webp", {37, 300}, {cv::IMWRITE_WEBP_QUALITY, 101}));
  ASSERT_TRUE(lossless);
  EXPECT_EQ(lossless->width, 37);
  EXPECT_EQ(lossless->height, 300);
  const auto progressive = base::sizeInHeader(encoded(".jpg", {37, 300}, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}));
  ASSERT_TRUE(progressive);
  EXPECT_EQ(progressive->width, 37);
  Bytes upsideDown = encoded(".bmp", {37, 300});
  put(upsideDown, 22, static_cast<std::uint32_t>(-300), false);
  EXPECT_EQ(base::sizeInHeader(upsideDown)->height, 300);
  const std::string pgm = "P5\n# from a camera\n 37\t300\n255\n";
  EXPECT_EQ(base::sizeInHeader(Bytes(pgm.begin(), pgm.end()))->height, 300);
  const std::string endless = "P5 " + std::string(1000, '9') + " 1 255\n";
  EXPECT_THAT(base::imageRefusal(Bytes(endless.begin(), endless.end())), HasSubstr("at most"));
}

TEST(ImageHeader, RefusesWhatExpandsOrIsNoImage) {
  EXPECT_EQ(base::imageRefusal(hugePng(8192, 8192)), "");
  EXPECT_EQ(base::imageRefusal(hugePng(24000, 24000)),
            "the image has 24000x24000 pixels; at most 32768 a side and 67108864 in all can be used");
  EXPECT_THAT(base::imageRefusal(hugePng(40000, 1)), HasSubstr("40000x1"));
  EXPECT_THAT(base::imageRefusal(hugePng(0, 5)), HasSubstr("damaged"));
  Bytes tiff = encoded(".tif", {37, 300});
  for (std::size_t i = 8; i + 12 <= tiff.size(); ++i)  // the entry of the width: tag 256
    if (tiff[i] == 0 && tiff[i + 1] == 1 && (tiff[i + 2] == 3 || tiff[i + 2] == 4) && tiff[i + 4] == 1) {
      tiff[i + 2] = 4;
      put(tiff, i + 8, 4000000000u, false);
    }
  EXPECT_THAT(base::imageRefusal(tiff), HasSubstr("4000000000x300"));
  EXPECT_EQ(base::imageRefusal({}), "the file is empty");
  const std::string letter = "dear mother";
  EXPECT_THAT(base::imageRefusal(Bytes(letter.begin(), letter.end())), HasSubstr("not an image"));
}

/// Wherever a file ends, a size is found or none; nothing is read beyond the end.
TEST(ImageHeader, EndsWithTheFile) {
  for (const char* extension : {".jpg", ".png", ".bmp", ".ppm", ".tif", ".webp"}) {
    const Bytes whole = encoded(extension, {16, 16});
    for (std::size_t n = 0; n < std::min<std::size_t>(whole.size(), 400); ++n) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
      const auto size = base::sizeInHeader(cut);
      EXPECT_LE(size ? std::max(size->width, size->height) : 0, 16) << extension << n;
    }
  }
}

TEST(ImageFolder, AnImageThatExpandsIsLeftOutByItsHeader) {
  const TempFolder folder;
  cv::imwrite(folder.path("1.png"), picture(1));
  writeAll(folder.path("2.png"), hugePng(24000, 24000));
  auto source = openImageFolder(folder.path(""));
  EXPECT_EQ(readFrames(*source).size(), 1u);
  EXPECT_THAT(source->problem(), HasSubstr("2.png: the image has 24000x24000 pixels; at most"));
  EXPECT_THROW(base::readImageBytes(folder.path("2.png")), base::Error);
  EXPECT_EQ(base::readImageBytes(folder.path("1.png")), readAll(folder.path("1.png")));
}

}  // namespace
}  // namespace engram::sources::test

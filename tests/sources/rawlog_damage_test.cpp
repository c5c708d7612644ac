// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/sources/rawlog_source.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sys/resource.h>
#include <zlib.h>

namespace engram::sources::test {
namespace {

using ::testing::HasSubstr;

constexpr int kImages = 6;

Objects smallLog() {
  Objects objects;
  for (int i = 0; i < kImages; ++i) {
    objects.push_back(odometryObject(kStart + i, i, 0, 0));
    objects.push_back(sensoryFrame({laserObject(kStart + i), imageObject(kStart + i, picture(i, {48, 32}))}));
    objects.push_back(actionObject(kStart + i, 1, 0, 0));
    objects.push_back(
        i % 2 == 0 ? imageObject(kStart + i + 0.5, picture(i, {48, 32}, 1))
                   : stereoObject(kStart + i + 0.5, picture(i, {24, 16}), picture(i, {24, 16}), "CAM"));
  }
  objects.push_back(laserObject(kStart + kImages));
  return objects;
}

std::string openError(const std::string& path) {
  try {
    openRawlog(path);
  } catch (const base::Error& e) {
    return e.what();
  }
  return "";
}

/// Where each delivered frame differs from the undamaged reading; frames are told apart by their stamps.
struct Reading {
  std::vector<types::Frame> frames;
  std::string problem, openError;
};

Reading readDamaged(const std::string& path) {
  Reading reading;
  RawlogParams params;
  params.odometry = "none";
  params.look_ahead = 1;
  try {
    auto source = openRawlog(path, params);
    reading.frames = readFrames(*source);
    reading.problem = source->problem();
  } catch (const base::Error& e) {
    reading.openError = e.what();
  }
  return reading;
}

TEST(RawlogDamage, ErrorsAtOpen) {
  const TempFolder folder;
  EXPECT_THAT(openError(folder.path("none.rawlog")), HasSubstr("none.rawlog: no such file"));
  EXPECT_THAT(openError(folder.path("")), HasSubstr("is a folder"));
  writeAll(folder.path("empty.rawlog"), {});
  EXPECT_THAT(openError(folder.path("empty.rawlog")), HasSubstr("the file is empty"));
  std::ofstream(folder.path("text.rawlog")) << "this is no rawlog at all, but some text";
  EXPECT_THAT(openError(folder.path("text.rawlog")), HasSubstr("not a rawlog"));
  const char old[] = "\x0D\0\0\0CSensoryFrame";
  std::ofstream(folder.path("old.rawlog")).write(old, sizeof old);
  EXPECT_THAT(openError(folder.path("old.rawlog")), HasSubstr("before 0.5.5"));
}

/// The first byte of each image of the file and the images before any byte are what the undamaged reading
/// tells.
TEST(RawlogDamage, TruncatedAnywhereDeliversAllBefore) {
  const TempFolder folder;
  for (const bool gzip : {false, true}) {
    writeWithMrpt(folder.path("a.rawlog"), smallLog(), gzip);
    const auto whole = readAll(folder.path("a.rawlog"));
    const auto all = readDamaged(folder.path("a.rawlog"));
    ASSERT_EQ(all.problem.find("damaged"), std::string::npos) << all.problem;
    std::size_t before = 0;
    int clean = 0;
    for (std::size_t length = 150; length < whole.size(); length += gzip ? 97 : 211) {
      writeAll(folder.path("cut.rawlog"),
               {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
      const auto reading = readDamaged(folder.path("cut.rawlog"));
      ASSERT_GE(reading.frames.size(), before) << "a longer file gave fewer images";
      before = reading.frames.size();
      for (std::size_t i = 0; i < before; ++i)
        ASSERT_EQ(difference(reading.frames[i].image, all.frames[i].image), 0.0) << length;
      const bool said = (reading.problem + reading.openError).find("truncated") != std::string::npos;
      clean += said ? 0 : 1;
    }
    EXPECT_GE(before + 2, all.frames.size());
    // A plain file cut between two objects cannot be told from a complete one.
    EXPECT_LE(clean, gzip ? 0 : 2);
  }
}

std::vector<unsigned char> flipped(std::vector<unsigned char> bytes, base::Rng& rng) {
  const auto at = rng.below(static_cast<std::uint32_t>(bytes.size()));
  bytes[at] ^= static_cast<unsigned char>(1u << rng.below(8));
  return bytes;
}

double peakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// One random bit flipped, thousands of times. No crash, no exit, no noise, no gigabytes; the frames before
// the flip are the undamaged ones, and gzip, which has a checksum, never keeps silent.
TEST(RawlogDamage, RandomBitFlips) {
  const TempFolder folder;
  base::Rng rng(7);
  testing::internal::CaptureStderr();
  for (const bool gzip : {false, true}) {
    writeWithMrpt(folder.path("a.rawlog"), smallLog(), gzip);
    const auto whole = readAll(folder.path("a.rawlog"));
    const auto all = readDamaged(folder.path("a.rawlog"));
    for (int i = 0; i < 2000; ++i) {
      const auto bytes = flipped(whole, rng);
      writeAll(folder.path("flip.rawlog"), bytes);
      const auto reading = readDamaged(folder.path("flip.rawlog"));
      const auto at = static_cast<std::size_t>(
          std::mismatch(whole.begin(), whole.end(), bytes.begin()).first - whole.begin());
      // Some bits of a gzip file mean nothing (the time in its header, padding): then all is as it was. A
      // plain file has no checksum; a flip in a class name turns an image into an object that nobody knows.
      const bool silent = reading.problem.empty() && reading.openError.empty();
      // Images take nearly equal space: those that end well before the flip must be untouched.
      const std::size_t expected = at * all.frames.size() / whole.size();
      const std::size_t sure =
          silent && gzip ? all.frames.size() : expected - std::min<std::size_t>(expected, 2);
      ASSERT_GE(reading.frames.size(), sure);
      for (std::size_t k = 0; k < sure; ++k)
        ASSERT_EQ(difference(reading.frames[k].image, all.frames[k].image), 0.0) << "flip at " << at;
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_LT(peakMegabytes(), 800.0);
}

// Damage that survives the gzip checksum: bytes overwritten before compression, whole blocks of them.
TEST(RawlogDamage, RandomGarbageBlocks) {
  const TempFolder folder;
  base::Rng rng(8);
  writeWithMrpt(folder.path("a.rawlog"), smallLog(), false);
  const auto whole = readAll(folder.path("a.rawlog"));
  testing::internal::CaptureStderr();
  for (int i = 0; i < 1000; ++i) {
    auto bytes = whole;
    const auto at = rng.below(static_cast<std::uint32_t>(whole.size()));
    const auto n = std::min<std::size_t>(1 + rng.below(64), whole.size() - at);
    for (std::size_t k = 0; k < n; ++k)
      bytes[at + k] = static_cast<unsigned char>(rng.below(4) == 0 ? 0xFF : rng.below(256));
    writeAll(folder.path("garbage.rawlog"), bytes);
    readDamaged(folder.path("garbage.rawlog"));
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_LT(peakMegabytes(), 800.0);
}

TEST(RawlogDamage, DamagedJpegIsLeftOutAndTheRestRead) {
  const TempFolder folder;
  Objects objects;
  for (int i = 0; i < 3; ++i) objects.push_back(imageObject(kStart + i, picture(i)));
  writeWithMrpt(folder.path("a.rawlog"), objects, false);
  auto bytes = readAll(folder.path("a.rawlog"));
  const std::size_t third = bytes.size() / 3;
  for (std::size_t i = third + third / 2; i < third + third / 2 + 40; ++i)
    bytes[i] = 0x55;  // the second JPEG
  bytes[third + third / 2 + 41] = 0xFF;
  bytes[third + third / 2 + 42] = 0xD9;  // an early end of the image
  writeAll(folder.path("a.rawlog"), bytes);
  const auto reading = readDamaged(folder.path("a.rawlog"));
  ASSERT_EQ(reading.frames.size(), 2u);
  EXPECT_THAT(reading.problem, HasSubstr("1 image left out: damaged (damaged JPEG"));
}

TEST(RawlogDamage, MessageNamesPlaceAndReason) {
  const TempFolder folder;
  writeWithMrpt(folder.path("a.rawlog"), smallLog(), false);
  auto bytes = readAll(folder.path("a.rawlog"));
  bytes.resize(bytes.size() - 5);
  writeAll(folder.path("a.rawlog"), bytes);
  const auto reading = readDamaged(folder.path("a.rawlog"));
  EXPECT_THAT(reading.problem, HasSubstr("damaged at byte"));
  EXPECT_THAT(reading.problem, HasSubstr("it is truncated; 12 images read"));
}

}  // namespace
}  // namespace engram::sources::test

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/recorder.h"

#include "engram/base/error.h"
#include "engram/capture/stamp_statistics.h"
#include "engram/sources/rawlog_source.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <numeric>
#include <random>

namespace engram::capture {
namespace {

using sources::test::kStart;
using sources::test::picture;
using sources::test::TempFolder;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

types::Frame makeFrame(int number, double rate = 20.0) {
  types::Frame frame;
  frame.stamp = kStart + number / rate;
  frame.image = picture(number, {64, 48}, 1);
  return frame;
}

std::size_t imagesIn(const std::string& path) {
  auto source = sources::openRawlog(path);
  const auto frames = sources::test::readFrames(*source);
  EXPECT_EQ(source->problem(), "");
  return frames.size();
}

TEST(Recorder, BeginsNewFilesByTime) {
  const TempFolder folder;
  Recorder recorder(folder.path("day.rawlog"), {.rotate_s = 2.0});
  for (int i = 0; i < 100; ++i) recorder.add(makeFrame(i));
  recorder.close();
  const auto files = recorder.files();
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].path, folder.path("day_001.rawlog"));
  EXPECT_EQ(files[2].path, folder.path("day_003.rawlog"));
  EXPECT_EQ(imagesIn(files[0].path), 40u);
  EXPECT_EQ(imagesIn(files[1].path), 40u);
  EXPECT_EQ(imagesIn(files[2].path), 20u);
  EXPECT_EQ(recorder.framesSafe(), 100u);
  EXPECT_EQ(files[0].bytes, fs::file_size(files[0].path));
}

TEST(Recorder, BeginsNewFilesBySize) {
  for (const bool external : {false, true}) {
    const TempFolder folder;
    RecorderParams params{.rotate_mb = 0.02};
    params.writer.external_images = external;
    Recorder recorder(folder.path("day.rawlog"), params);
    for (int i = 0; i < 100; ++i) {
      recorder.add(makeFrame(i));
      recorder.tick(i / 2.0);  // size counts when it is on the disk
    }
    recorder.close();
    std::size_t total = 0;
    const auto files = recorder.files();
    EXPECT_GT(files.size(), 3u);
    for (const auto& file : files) {
      EXPECT_LT(file.bytes, 26000u);
      total += imagesIn(file.path);
    }
    EXPECT_EQ(total, 100u);
  }
}

TEST(Recorder, NothingIsOverwrittenUnasked) {
  const TempFolder folder;
  { Recorder(folder.path("day.rawlog"), {.rotate_s = 1.0}).add(makeFrame(0)); }
  EXPECT_TRUE(fs::exists(folder.path("day_001.rawlog")));
  EXPECT_THROW(Recorder(folder.path("day.rawlog"), {.rotate_s = 1.0}), base::Error);
  fs::rename(folder.path("day_001.rawlog"), folder.path("day_007.rawlog"));
  EXPECT_THROW(Recorder(folder.path("day.rawlog"), {.rotate_s = 1.0}), base::Error);  // it would come to that
  RecorderParams params{.rotate_s = 1.0};
  params.writer.overwrite = true;
  EXPECT_NO_THROW(Recorder(folder.path("day.rawlog"), params));
}

TEST(Recorder, FlushesInTime) {
  const TempFolder folder;
  Recorder recorder(folder.path("a.rawlog"), {.flush_s = 0.5});
  std::size_t before = 0;
  for (int i = 0; i < 100; ++i) {
    recorder.add(makeFrame(i));
    recorder.tick(100.0 + i / 20.0);
    EXPECT_GE(recorder.framesSafe() + 10, static_cast<std::size_t>(i + 1));  // 0.5 s of 20 Hz
    EXPECT_GE(recorder.framesSafe(), before);
    before = recorder.framesSafe();
  }
}

TEST(StampStatistics, KnowsRateJitterAndGaps) {
  StampStatistics statistics;
  for (int i = 0; i < 1000; ++i) {
    if (i >= 200 && i < 205) continue;  // five are missing
    if (i == 600) continue;
    const double jitter = i % 2 == 0 ? 0.001 : -0.001;
    statistics.add(kStart + 0.05 * i + jitter);
  }
  const auto s = statistics.summary();
  EXPECT_EQ(s.images, 994u);
  EXPECT_NEAR(s.rate, 993.0 / (0.05 * 999), 0.01);
  EXPECT_NEAR(s.interval, 0.05, 2.1e-3);
  EXPECT_NEAR(s.jitter, 2e-3, 2.1e-3);
  EXPECT_NEAR(s.longest, 0.3, 3e-3);
  ASSERT_EQ(s.gaps.size(), 2u);
  EXPECT_NEAR(s.gaps[0].from, kStart + 0.05 * 199, 2e-3);
  EXPECT_EQ(s.gaps[0].missing, 5u);
  EXPECT_EQ(s.gaps[1].missing, 1u);
  EXPECT_EQ(s.missing, 6u);
}

TEST(StampStatistics, KnowsThePeriodWhenMostImagesAreLost) {
  std::mt19937 random(3);
  for (const double loss : {0.2, 0.6, 0.85}) {
    StampStatistics statistics;
    std::bernoulli_distribution lost(loss);
    std::normal_distribution<double> jitter(0.0, 1e-3);
    std::size_t arrived = 0;
    for (int i = 0; i < 2000; ++i) {
      if (i > 0 && i < 1999 && lost(random)) continue;
      statistics.add(kStart + i / 30.0 + jitter(random));
      ++arrived;
    }
    const auto s = statistics.summary();
    EXPECT_NEAR(s.interval, 1.0 / 30.0, 1e-3) << loss;
    EXPECT_NEAR(static_cast<double>(s.missing), static_cast<double>(2000 - arrived), 20.0) << loss;
    EXPECT_LT(s.jitter, 2e-3);
  }
}

TEST(StampStatistics, ImagesTakenAtWillHaveTheirMedian) {
  StampStatistics statistics;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> interval(0.1, 2.0);
  double stamp = kStart;
  for (int i = 0; i < 1001; ++i) statistics.add(stamp += interval(random));
  EXPECT_NEAR(statistics.summary().interval, 1.05, 0.1);
}

TEST(StampStatistics, NeedsTwoImages) {
  StampStatistics statistics;
  EXPECT_EQ(statistics.summary().images, 0u);
  statistics.add(5.0);
  EXPECT_EQ(statistics.summary().rate, 0.0);
  statistics.add(5.0);  // the same stamp: no interval
  EXPECT_EQ(statistics.summary().rate, 0.0);
  statistics.add(5.5);
  EXPECT_NEAR(statistics.summary().rate, 2.0, 1e-12);
}

}  // namespace
}  // namespace engram::capture

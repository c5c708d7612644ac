// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Recordings that cannot be made again: crash, full disk, and replay bit for bit.
#include "engram/base/error.h"
#include "engram/sources/odometry_track.h"
#include "engram/sources/rawlog_writer.h"
#include "rawlog_fixture.h"

#include <gmock/gmock.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/serialization/CArchive.h>

#include <csignal>
#include <numbers>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace engram::sources::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

types::Frame makeFrame(int number, int channels = 1) {
  types::Frame frame;
  frame.stamp = kStart + 0.1 * number + 1.23e-8;  // finer than a rawlog stores
  frame.image = picture(number, {64, 48}, channels);
  frame.T_odom_robot = types::toIsometry({0.1 * number, -0.2, 0.7 * number});
  return frame;
}

RawlogWriterParams live(bool external = false) {
  RawlogWriterParams params;
  params.live = true;
  params.external_images = external;
  return params;
}

std::size_t readableFrames(const std::string& path, bool whole = true) {
  auto source = openRawlog(path);
  const auto frames = readFrames(*source);
  EXPECT_TRUE(!whole || source->problem().empty()) << source->problem();
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_LT(difference(frames[i].image, picture(static_cast<int>(i), {64, 48}, 1)), 4.0);
  return frames.size();
}

/// A child writes 20 frames, flushes, writes 5 more, says so, and is killed.
void killARecording(const std::string& path, const RawlogWriterParams& params) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    RawlogWriter writer(path, params);
    for (int i = 0; i < 25; ++i) {
      writer.add(makeFrame(i));
      if (i == 19) writer.flush();
    }
    [[maybe_unused]] const auto n = write(ready[1], "x", 1);
    pause();
    std::_Exit(1);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  close(ready[0]);
  close(ready[1]);
}

TEST(LiveRawlog, AKilledRecordingHoldsEverythingUpToTheLastFlush) {
  for (const bool external : {false, true}) {
    const TempFolder folder;
    const std::string path = folder.path("a.rawlog");
    killARecording(path, live(external));
    EXPECT_GE(readableFrames(path, false), 20u) << external;
  }
}

TEST(LiveRawlog, AFlushedFileIsAWholeRawlogForMrptToo) {
  const TempFolder folder;
  const std::string path = folder.path("a.rawlog");
  RawlogWriter writer(path, live());
  for (int i = 0; i < 6; ++i) {
    writer.add(makeFrame(i));
    if (i == 2) writer.flush();
  }
  EXPECT_EQ(writer.frames(), 6u);
  EXPECT_EQ(writer.framesSafe(), 3u);
  writer.flush();
  writer.flush();  // nothing new: no empty member
  const auto source = openRawlog(path);
  EXPECT_EQ(readFrames(*source).size(), 6u);
  EXPECT_EQ(source->problem(), "");
  mrpt::io::CFileGZInputStream stream(path);
  auto archive = mrpt::serialization::archiveFrom(stream);
  for (int i = 0; i < 12; ++i) EXPECT_TRUE(archive.ReadObject());
  EXPECT_THROW(archive.ReadObject(), mrpt::serialization::CExceptionEOF);
  EXPECT_EQ(writer.bytes(), fs::file_size(path));
}

TEST(LiveRawlog, WithoutCloseEverythingIsKept) {
  for (const bool external : {false, true}) {
    const TempFolder folder;
    const std::string path = folder.path("a.rawlog");
    {
      RawlogWriter writer(path, live(external));
      for (int i = 0; i < 4; ++i) writer.add(makeFrame(i));
    }
    auto source = openRawlog(path);
    EXPECT_EQ(readFrames(*source).size(), 4u);
    EXPECT_EQ(source->problem(), "");
    EXPECT_FALSE(fs::exists(path + ".part"));
  }
}

TEST(LiveRawlog, ARecordingOfNothingLeavesNothing) {
  const TempFolder folder;
  { RawlogWriter writer(folder.path("a.rawlog"), live(true)); }
  RawlogWriter closed(folder.path("b.rawlog"), live());
  closed.close();
  EXPECT_TRUE(fs::exists(folder.path("b.rawlog")));  // closed on purpose
  EXPECT_FALSE(fs::exists(folder.path("a.rawlog")));
  EXPECT_FALSE(fs::exists(folder.path("a_Images")));
}

TEST(LiveRawlog, AFullDiskKeepsWhatWasFlushed) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const TempFolder folder;
  const std::string path = folder.path("a.rawlog");
  std::size_t safe = 0;
  std::string message;
  {
    RawlogWriter writer(path, live());
    const rlimit limit{40000, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      for (int i = 0; i < 1000; ++i) {
        writer.add(makeFrame(i));
        if (i % 4 == 3) writer.flush();
      }
    } catch (const base::Error& e) {
      message = e.what();
    }
    setrlimit(RLIMIT_FSIZE, &old);
    safe = writer.framesSafe();
    EXPECT_EQ(writer.bytes(), fs::file_size(path));
    EXPECT_THROW(writer.add(makeFrame(0)), base::Error);
  }
  EXPECT_THAT(message, HasSubstr("free some space"));
  EXPECT_GT(safe, 8u);
  EXPECT_EQ(readableFrames(path), safe);
}

TEST(LiveRawlog, AReplayIsTheLiveRunBitForBit) {
  for (const bool external : {false, true}) {
    for (const bool stereo : {false, true}) {
      const TempFolder folder;
      const std::string path = folder.path("a.rawlog");
      std::vector<types::Frame> seen;
      RawlogWriter writer(path, live(external));
      for (int i = 0; i < 30; ++i) {
        types::Frame frame = makeFrame(i, i % 2 == 0 ? 3 : 1);
        frame.index = 1000;
        frame.T_odom_robot = types::toIsometry({1e3 / (1 + i), std::numbers::pi * i, 0.01 + 0.7 * i});
        if (stereo) frame.right = picture(100 + i, {64, 48}, 1);
        seen.push_back(writer.addReplayable(frame));
      }
      writer.close();
      auto source = openRawlog(path);
      const auto replay = readFrames(*source);
      ASSERT_EQ(replay.size(), seen.size());
      for (std::size_t i = 0; i < seen.size(); ++i) {
        EXPECT_EQ(replay[i].index, seen[i].index);
        EXPECT_EQ(replay[i].stamp, seen[i].stamp);
        EXPECT_EQ(replay[i].label, seen[i].label);
        EXPECT_EQ(replay[i].T_odom_robot->matrix(), seen[i].T_odom_robot->matrix());
        EXPECT_EQ(difference(replay[i].image, seen[i].image), 0.0);
        ASSERT_EQ(replay[i].right.empty(), !stereo);
        if (stereo) {
          EXPECT_EQ(difference(replay[i].right, seen[i].right), 0.0);
        }
      }
    }
  }
}

TEST(LiveRawlog, OtherObjectsLieBetweenTheFrames) {
  const TempFolder folder;
  const std::string path = folder.path("a.rawlog");
  RawlogWriter writer(path, live());
  mrpt::obs::CObservationComment comment;
  comment.text = "the camera was lost";
  writer.add(makeFrame(0));
  writer.addObject(comment);
  writer.add(makeFrame(1));
  writer.close();
  auto source = openRawlog(path);
  EXPECT_EQ(readFrames(*source).size(), 2u);
  EXPECT_EQ(source->problem(), "");
  EXPECT_EQ(source->stats().objects.at("CObservationComment").begin()->second, 1u);
}

}  // namespace
}  // namespace engram::sources::test

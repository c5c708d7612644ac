// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The camera as a plug-in of MRPT's own recorder. RawlogGrabberApp is all that the program rawlog-grabber
// has.
#include "engram/sources/rawlog_source.h"
#include "rawlog_fixture.h"

#include <gtest/gtest.h>
#include <mrpt/apps/RawlogGrabberApp.h>

#include <cstdlib>
#include <dlfcn.h>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

namespace engram::apps {
namespace {

using sources::test::TempFolder;

/// rawlog-grabber ends at once when its standard input is at the end.
class OpenInput {
 public:
  OpenInput() : before_(dup(STDIN_FILENO)) {
    if (pipe(ends_) == 0) dup2(ends_[0], STDIN_FILENO);
  }
  ~OpenInput() {
    if (before_ >= 0) dup2(before_, STDIN_FILENO);
    for (const int end : {ends_[0], ends_[1], before_}) close(end);
  }

 private:
  int before_;
  int ends_[2] = {-1, -1};
};

std::string grab(const std::string& config, double seconds) {
  const OpenInput input;
  mrpt::apps::RawlogGrabberApp app;
  app.setMinLoggingLevel(mrpt::system::LVL_ERROR);
  const char* arguments[] = {"rawlog-grabber", "-p", ENGRAM_GRABBER_PLUGIN, config.c_str()};
  app.initialize(4, arguments);
  app.run_for_seconds = seconds;
  app.run();
  return app.rawlog_filename;
}

TEST(GrabberPluginDeathTest, LoadedWithoutStandardErrorItKeepsThatNumberFromFiles) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        close(STDERR_FILENO);
        const bool loaded = dlopen(ENGRAM_GRABBER_PLUGIN, RTLD_NOW) != nullptr;
        std::_Exit(loaded && open("/dev/null", O_RDONLY) > STDERR_FILENO ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

TEST(GrabberPlugin, RawlogGrabberRecordsOurCamera) {
  const TempFolder folder;
  const std::string config = folder.path("grabber.ini");
  std::ofstream(config) << "[global]\nrawlog_prefix = " << folder.path("drive")
                        << "\ntime_between_launches = 0\nSF_max_time_span = 0.1\nuse_sensoryframes = 0\n"
                           "GRABBER_PERIOD_MS = 50\n"
                           "[front]\ndriver = EngramGigECamera\nprocess_rate = 50\nsensorLabel = FRONT\n"
                           "camera = Fake_1\nwidth = 64\nheight = 48\nframe_rate = 40\npixel_format = RGB8\n"
                           "[front.features]\nrawlog-grabber-ignore = true\nTestRegister = 5\n";
  const std::string rawlog = grab(config, 1.5);
  auto source = sources::openRawlog(rawlog);
  const auto frames = sources::test::readFrames(*source);
  EXPECT_EQ(source->problem(), "");
  EXPECT_GT(frames.size(), 15u);
  EXPECT_EQ(source->stats().cameras.count("FRONT"), 1u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].image.size(), cv::Size(64, 48));
    EXPECT_EQ(frames[i].image.channels(), 3);
    if (i > 0) {
      EXPECT_GT(frames[i].stamp, frames[i - 1].stamp);
    }
  }
}

TEST(GrabberPlugin, ABadKeyEndsRawlogGrabberWithTheReason) {
  const TempFolder folder;
  const std::string config = folder.path("grabber.ini");
  std::ofstream(config) << "[global]\nrawlog_prefix = " << folder.path("drive")
                        << "\ntime_between_launches = 0\nSF_max_time_span = 0.1\nuse_sensoryframes = 0\n"
                           "GRABBER_PERIOD_MS = 50\n[front]\ndriver = EngramGigECamera\nprocess_rate = 50\n"
                           "camera = Fake_1\nexposur_us = 4\n";
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const std::string rawlog = grab(config, 20.0);
  const std::string said = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("did you mean 'exposure_us'?"), std::string::npos) << said;
}

}  // namespace
}  // namespace engram::apps

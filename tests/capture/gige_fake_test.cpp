// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Aravis' simulated camera without a network.
#include "engram/base/error.h"
#include "engram/capture/gige_grabber.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

namespace engram::capture {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

GigeParams fake() {
  GigeParams params;
  params.camera = "Fake_1";
  params.width = 64;
  params.height = 48;
  params.frame_rate = 100.0;
  return params;
}

/// The first `n` frames that a camera gives.
std::vector<types::Frame> firstFrames(const GigeParams& params, std::size_t n, GrabStats* stats = nullptr) {
  std::vector<types::Frame> frames;
  std::mutex mutex;
  std::atomic<std::size_t> count{0};
  GigeGrabber grabber(params, [&](types::Frame&& frame) {
    const std::lock_guard lock(mutex);
    frames.push_back(std::move(frame));
    ++count;
  });
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (count < n && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(2ms);
  grabber.stop();
  if (stats) *stats = grabber.stats();
  EXPECT_GE(frames.size(), n);
  return frames;
}

TEST(GigeFake, EveryFormatBecomesAnEightBitImage) {
  for (const auto& [format, channels] :
       {std::pair("Mono8", 1), std::pair("Mono16", 1), std::pair("BayerRG8", 3), std::pair("BayerBG8", 3),
        std::pair("BayerGR8", 3), std::pair("BayerGB8", 3), std::pair("RGB8", 3)}) {
    GigeParams params = fake();
    params.pixel_format = format;
    const auto frames = firstFrames(params, 3);
    EXPECT_EQ(frames[2].image.type(), CV_8UC(channels)) << format;
    EXPECT_EQ(frames[2].image.size(), cv::Size(64, 48)) << format;
  }
}

TEST(GigeFake, TwoCamerasMakeAStereoPair) {
  GigeParams params = fake();
  params.right_camera = "Fake_1";
  GrabStats stats;
  const auto frames = firstFrames(params, 30, &stats);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].index, i);
    EXPECT_EQ(frames[i].right.size(), frames[i].image.size());
  }
  EXPECT_EQ(stats.cameras.size(), 2u);
  EXPECT_EQ(stats.frames, frames.size());
  const std::size_t waiting = 16;
  EXPECT_GE(2 * stats.frames + stats.unpaired + waiting, stats.cameras[0].whole + stats.cameras[1].whole);
}

TEST(GigeFake, SettingsThatAreRefusedAreNamed) {
  const auto refusal = [](auto change) -> std::string {
    GigeParams params = fake();
    change(params);
    try {
      const GigeGrabber grabber(params, [](types::Frame&&) {});
    } catch (const base::Error& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal([](GigeParams& p) { p.width = 5000; }), HasSubstr("width = 5000 is refused"));
  EXPECT_THAT(refusal([](GigeParams& p) { p.pixel_format = "Mono99"; }), HasSubstr("pixel_format = Mono99"));
  EXPECT_THAT(refusal([](GigeParams& p) { p.gain = 1000; }), HasSubstr("gain = 1000 is refused"));
  EXPECT_THAT(refusal([](GigeParams& p) { p.trigger = "Line99"; }), HasSubstr("trigger = Line99 is refused"));
  EXPECT_THAT(refusal([](GigeParams& p) {
                p.trigger = "software";
                p.frame_rate = 0;
              }),
              HasSubstr("needs frame_rate"));
  EXPECT_THAT(refusal([](GigeParams& p) {
                p.features = {{"Nonsense", "3"}};
              }),
              HasSubstr("feature Nonsense = 3"));
  EXPECT_THAT(refusal([](GigeParams& p) {
                p.features = {{"Width", "abc"}};
              }),
              HasSubstr("feature Width = abc"));
  EXPECT_THAT(refusal([](GigeParams& p) { p.buffers = 1; }), HasSubstr("buffers: 1 is out of range"));
  EXPECT_EQ(refusal([](GigeParams&) {}), "accepted");
}

TEST(GigeFake, AnExceptionOfTheUserEndsTheRunWithItsMessage) {
  GigeGrabber grabber(fake(), [](types::Frame&&) { throw base::Error("no room"); });
  const auto end = std::chrono::steady_clock::now() + 5s;
  while (grabber.failure().empty() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(5ms);
  EXPECT_THAT(grabber.failure(), HasSubstr("no room"));
}

TEST(GrabStats, AdviceNamesTheSettingThatHelps) {
  GrabStats stats;
  EXPECT_EQ(adviceOnLoss(stats), "");
  auto& camera = stats.cameras.emplace_back();
  camera.settings.payload = 4 << 20;
  camera.settings.packetSize = 1400;
  camera.settings.socketLimit = 212992;
  EXPECT_EQ(adviceOnLoss(stats), "");  // nothing was lost
  camera.incomplete = 3;
  EXPECT_THAT(adviceOnLoss(stats), HasSubstr("sysctl -w net.core.rmem_max=16777216"));
  camera.settings.socketBuffer = 100 << 10;
  EXPECT_THAT(adviceOnLoss(stats), HasSubstr("raise socket_buffer_mb to 9"));
  camera.settings.socketBuffer = 16 << 20;
  camera.settings.socketLimit = 64 << 20;
  EXPECT_THAT(adviceOnLoss(stats), HasSubstr("packet_delay_us"));
  camera.cuts = 3;
  EXPECT_EQ(adviceOnLoss(stats), "");  // each time the camera was lost, an image was under way
  camera.packets.underruns = 2;
  EXPECT_THAT(adviceOnLoss(stats), HasSubstr("raise buffers"));
}

}  // namespace
}  // namespace engram::capture

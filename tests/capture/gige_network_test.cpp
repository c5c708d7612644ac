// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The real protocol on the loopback interface.
#include "camera_process.h"
#include "engram/base/error.h"
#include "engram/capture/discovery.h"
#include "engram/capture/fake_server.h"
#include "engram/capture/gige_grabber.h"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include <chrono>
#include <mutex>
#include <thread>

namespace engram::capture {
namespace {

using engram::testing::FakeCameraProcess;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

/// Frames as they come.
class Collector {
 public:
  GigeGrabber::Sink sink() {
    return [this](types::Frame&& frame) {
      const std::lock_guard lock(mutex_);
      frames_.push_back(std::move(frame));
    };
  }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return frames_.size();
  }
  /// False when so many frames do not come within `patience`.
  bool waitFor(std::size_t n, std::chrono::milliseconds patience) const {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (size() < n && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
    return size() >= n;
  }
  std::vector<types::Frame> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<types::Frame> frames_;
};

GigeParams loopback() {
  GigeParams params;
  params.camera = "127.0.0.1";
  return params;
}

/// A picture whose number can be read from every pixel row.
cv::Mat numbered(int n, int channels) {
  cv::Mat image(48, 64, CV_8UC(channels));
  cv::RNG(static_cast<std::uint64_t>(n) + 1).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_L1) == 0.0;
}

TEST(GigeNetwork, EveryPixelArrivesInOrder) {
  for (const int channels : {1, 3}) {
    int n = 0;
    const FakeServer server({.rate = 50.0}, numbered(0, channels), [&] { return numbered(n++, channels); });
    Collector got;
    GigeGrabber grabber(loopback(), got.sink());
    ASSERT_TRUE(got.waitFor(20, 5s));
    grabber.stop();
    const auto frames = got.frames();
    const GrabStats stats = grabber.stats();
    EXPECT_EQ(stats.frames, frames.size());
    EXPECT_EQ(stats.cameras[0].settings.format, channels == 1 ? "Mono8" : "RGB8");
    int picture = -1;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].index, i);
      EXPECT_EQ(frames[i].label, "CAMERA");
      int next = picture + 1;  // some may be lost on a busy computer, none may be wrong
      while (next < n && !same(frames[i].image, numbered(next, channels))) ++next;
      ASSERT_LT(next, n) << "frame " << i << " is none of those that were sent";
      picture = next;
    }
    EXPECT_NEAR(frames.back().stamp,
                std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(),
                1.0);
  }
}

TEST(GigeNetwork, AccountsForEveryImageOnALossyWay) {
  const FakeServer server({.rate = 200.0, .loss = 0.05}, numbered(0, 1), [] { return cv::Mat(); });
  GigeParams params = loopback();
  params.width = 64;
  params.packet_size = 500;  // 8 packets an image: two images of three arrive whole
  Collector got;
  GigeGrabber grabber(params, got.sink());
  ASSERT_TRUE(got.waitFor(150, 10s));
  const std::size_t sent = server.sent();
  std::this_thread::sleep_for(300ms);  // those on their way
  grabber.stop();
  const GrabStats stats = grabber.stats();
  const std::size_t known = stats.frames + stats.lost();
  EXPECT_GE(known + 2, sent);
  EXPECT_LE(known, server.sent());
  EXPECT_GT(stats.incomplete(), 20u);
  EXPECT_GT(stats.missed(), 0u);  // the leader was lost
  EXPECT_GT(stats.cameras[0].packets.missing, 20u);
  EXPECT_THAT(adviceOnLoss(stats), HasSubstr("packet_delay_us"));
}

TEST(GigeNetwork, IsFoundAndSetUp) {
  FakeCameraProcess camera;
  std::this_thread::sleep_for(300ms);
  const auto cameras = discover();
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_EQ(cameras[0].id, "Aravis-Fake-GV01");
  EXPECT_EQ(cameras[0].address, "127.0.0.1");
  EXPECT_EQ(cameras[0].protocol, "GigEVision");

  GigeParams params;
  params.camera = cameras[0].id;
  params.width = 320;
  params.height = 240;
  params.offset_x = 16;
  params.frame_rate = 40.0;
  params.trigger = "software";
  params.exposure_us = 2000;
  params.gain = 1;
  params.features = {{"TestRegister", "77"}, {"GainAuto", "Off"}};
  Collector got;
  GigeGrabber grabber(params, got.sink());
  EXPECT_TRUE(got.waitFor(20, 5s));
  grabber.stop();
  const CameraSettings s = grabber.stats().cameras[0].settings;
  EXPECT_EQ(std::tuple(s.width, s.height, s.payload), std::tuple(320, 240, std::size_t{320 * 240}));
  EXPECT_EQ(std::tuple(s.vendor, s.model, s.serial, s.address),
            std::tuple("Aravis", "Fake", "GV01", "127.0.0.1"));
  EXPECT_EQ(got.frames()[0].image.size(), cv::Size(320, 240));
  const auto frames = got.frames();
  for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_GT(frames[i].stamp, frames[i - 1].stamp);
}

TEST(GigeNetwork, ComesBackAfterTheCameraWasAway) {
  auto camera = std::make_unique<FakeCameraProcess>();
  std::this_thread::sleep_for(300ms);
  GigeParams params = loopback();
  params.frame_rate = 50.0;
  params.width = params.height = 64;
  params.silence_s = 0.4;
  Collector got;
  GigeGrabber grabber(params, got.sink());
  ASSERT_TRUE(got.waitFor(20, 5s));
  camera->end(SIGKILL);
  std::this_thread::sleep_for(1s);
  const std::size_t before = got.size();
  camera = std::make_unique<FakeCameraProcess>();
  ASSERT_TRUE(got.waitFor(before + 20, 15s));
  grabber.stop();

  const GrabStats stats = grabber.stats();
  EXPECT_EQ(stats.reconnects(), 1u);
  ASSERT_EQ(stats.cameras[0].gaps.size(), 1u);
  const Gap gap = stats.cameras[0].gaps[0];
  EXPECT_GT(gap.to - gap.from, 1.0);
  const auto frames = got.frames();
  EXPECT_EQ(frames[before - 1].stamp, gap.from);
  EXPECT_EQ(frames[before].stamp, gap.to);
  EXPECT_EQ(frames[before].image.size(), cv::Size(64, 64));  // set up again
  EXPECT_EQ(grabber.failure(), "");
  const auto notices = grabber.takeNotices();
  ASSERT_EQ(notices.size(), 2u);
  EXPECT_THAT(notices[0], HasSubstr("is lost: no image for 0.4 s"));
  EXPECT_THAT(notices[1], HasSubstr("is back after"));
}

std::string refusal(const GigeParams& params) {
  try {
    const GigeGrabber grabber(params, [](types::Frame&&) {});
  } catch (const base::Error& e) {
    return e.what();
  }
  return {};
}

TEST(GigeNetwork, SaysWhyACameraCannotBeUsed) {
  FakeCameraProcess camera;
  std::this_thread::sleep_for(300ms);
  GigeParams params;
  params.camera = "Nope";
  EXPECT_THAT(refusal(params),
              HasSubstr("camera 'Nope' was not found; cameras that answer: Aravis-Fake-GV01"));

  Collector got;
  const GigeGrabber user(loopback(), got.sink());
  ASSERT_TRUE(got.waitFor(3, 5s));
  EXPECT_THAT(refusal(loopback()), HasSubstr("in use by another program"));
}

std::string refusalToServe(const std::string& interface) {
  try {
    const FakeServer server({.interface = interface}, numbered(0, 1), [] { return cv::Mat(); });
  } catch (const base::Error& e) {
    return e.what();
  }
  return {};
}

TEST(GigeNetwork, OneAddressServesOneCamera) {
  {
    const FakeServer first({.rate = 50.0}, numbered(0, 1), [] { return cv::Mat(); });
    for (const std::string interface : {"127.0.0.1", "lo"})
      EXPECT_THAT(refusalToServe(interface), HasSubstr("another program serves a camera there"));
    Collector got;  // and the first is none the worse for it
    const GigeGrabber user(loopback(), got.sink());
    EXPECT_TRUE(got.waitFor(3, 5s));
  }
  EXPECT_EQ(refusalToServe("127.0.0.1"), "");
  FakeCameraProcess other;
  std::this_thread::sleep_for(300ms);
  EXPECT_THAT(refusalToServe("127.0.0.1"), HasSubstr("UDP port 3956 is taken"));
}

TEST(GigeNetwork, OneCameraIsNoStereoPair) {
  GigeParams params = loopback();
  for (const std::string name : {"127.0.0.1", "Aravis-Fake-GV01"}) {
    const FakeServer server({.rate = 50.0}, numbered(0, 1), [] { return cv::Mat(); });
    params.right_camera = name;
    EXPECT_THAT(refusal(params), HasSubstr("right_camera: '" + name + "' is the left camera too"));
  }
}

TEST(GigeNetwork, SaysThatNoCameraAnswers) {
  EXPECT_THAT(refusal({}), HasSubstr("no camera was found; no camera answers"));
  EXPECT_THROW(FakeServer({.interface = "nonsense0"}, numbered(0, 1), [] { return cv::Mat(); }), base::Error);
  EXPECT_THROW(FakeServer({}, cv::Mat(3000, 10, CV_8UC1), [] { return cv::Mat(); }), base::Error);
}

}  // namespace
}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/gige_grabber.h"

#include "clock_map.h"
#include "engram/base/error.h"
#include "engram/capture/discovery.h"
#include "gige_camera.h"
#include "loss_counter.h"
#include "stereo_pairer.h"
#include "watchdog.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>

namespace engram::capture {
namespace {

using namespace std::chrono_literals;

double steadyNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string secondsText(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

/// What one camera delivers.
struct Shot {
  double stamp = 0.0;  ///< [s since the Unix epoch]
  cv::Mat image;
};

/// What the threads of the cameras share.
class Notices {
 public:
  void add(std::string text) {
    const std::lock_guard lock(mutex_);
    texts_.push_back(std::move(text));
  }
  std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(texts_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> texts_;
};

/// Keeps one camera going, in a thread of its own.
class Keeper {
 public:
  using Deliver = std::function<void(Shot&&)>;

  Keeper(const GigeParams& params, std::string id, Deliver deliver, Notices& notices)
      : params_(params),
        deliver_(std::move(deliver)),
        notices_(notices),
        watchdog_({.silence = params.silence_s, .giveUp = params.give_up_s}, steadyNow()),
        camera_(std::make_unique<GigeCamera>(params, id)) {
    stats_.settings = camera_->settings();
    id_ = stats_.settings.id;  // from now on this camera and no other
    watchdog_.connected(steadyNow());
  }
  ~Keeper() { stop(); }

  void start() {
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::string failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
  }
  CameraStats stats() const {
    const std::lock_guard lock(mutex_);
    return stats_;
  }

 private:
  void run();
  void tend();
  void grabOne();
  void updateStats(double stamp);
  void connect();
  void drop(const std::string& why);
  void updatePackets();
  void endWith(const std::string& failure);

  const GigeParams params_;
  std::string id_;
  Deliver deliver_;
  Notices& notices_;
  Watchdog watchdog_;
  std::unique_ptr<GigeCamera> camera_;
  PacketStats earlier_;  // of connections that are closed
  LossCounter losses_;
  ClockMap clock_;
  double lastStamp_ = 0.0;
  bool inGap_ = false;
  std::string lastRefusal_;

  std::atomic<bool> stopping_{false};
  std::thread thread_;
  mutable std::mutex mutex_;
  CameraStats stats_;    // under mutex_
  std::string failure_;  // under mutex_
};

void Keeper::run() {
  try {
    while (!stopping_ && failure().empty()) tend();
  } catch (const std::exception& e) {
    endWith(std::string("camera '") + id_ + "': " + e.what());
  }
  if (camera_) updatePackets();
  camera_.reset();
}

void Keeper::tend() {
  switch (watchdog_.advice(steadyNow())) {
    case Watchdog::Advice::kConnect:
      return connect();
    case Watchdog::Advice::kDrop:
      return drop("no image for " + secondsText(params_.silence_s));
    case Watchdog::Advice::kGiveUp:
      return endWith("camera '" + id_ + "' was lost for " + secondsText(params_.give_up_s) +
                     " (give_up_s): " + (lastRefusal_.empty() ? "no images" : lastRefusal_));
    case Watchdog::Advice::kWait:
      break;
  }
  if (!camera_) return std::this_thread::sleep_for(20ms);
  if (camera_->controlLost()) return drop("it does not answer any more");
  grabOne();
}

void Keeper::connect() {
  try {
    camera_ = std::make_unique<GigeCamera>(params_, id_);
    losses_.restart();
    clock_.restart();
    watchdog_.connected(steadyNow());
  } catch (const base::Error& e) {
    lastRefusal_ = e.what();
    watchdog_.failed(steadyNow());
  }
}

void Keeper::drop(const std::string& why) {
  if (!inGap_) notices_.add("camera '" + id_ + "' is lost: " + why + "; trying to connect it again");
  inGap_ = true;
  updatePackets();
  earlier_ = stats_.packets;
  camera_->abandon();
  camera_.reset();
  watchdog_.lost(steadyNow());
  const std::lock_guard lock(mutex_);
  ++stats_.cuts;
}

void Keeper::grabOne() {
  auto grabbed = camera_->grab(100ms);
  if (grabbed.kind == GigeCamera::Grabbed::Kind::kNothing) return updatePackets();
  const bool whole = grabbed.kind == GigeCamera::Grabbed::Kind::kWhole;
  whole ? void(losses_.whole(grabbed.number)) : losses_.incomplete();
  watchdog_.frame(steadyNow());  // an incomplete image is a sign of life as well
  Shot shot;
  if (whole) {
    const bool hasClock = grabbed.device > 0;
    const std::int64_t host = hasClock ? clock_.toHost(grabbed.device, grabbed.arrival) : grabbed.arrival;
    shot = {static_cast<double>(host) * 1e-9, std::move(grabbed.image)};
  }
  updateStats(whole ? shot.stamp : lastStamp_);
  updatePackets();
  if (whole) deliver_(std::move(shot));
}

/// @param stamp of the last whole image
void Keeper::updateStats(double stamp) {
  const std::lock_guard lock(mutex_);
  stats_.whole = losses_.wholeFrames();
  stats_.incomplete = losses_.incompleteFrames();
  stats_.missed = losses_.missed();
  stats_.clockDrift = clock_.drift();
  stats_.clockRestarts = clock_.restarts();
  if (inGap_ && stamp != lastStamp_) {
    inGap_ = false;
    stats_.gaps.push_back({lastStamp_, stamp});
    ++stats_.reconnects;
    notices_.add("camera '" + id_ + "' is back after " + secondsText(stamp - lastStamp_));
  }
  lastStamp_ = stamp;
}

void Keeper::updatePackets() {
  PacketStats total = earlier_;
  total += camera_->packets();
  const std::lock_guard lock(mutex_);
  stats_.packets = total;
}

void Keeper::endWith(const std::string& failure) {
  const std::lock_guard lock(mutex_);
  failure_ = failure;
}

}  // namespace

class GigeGrabber::Impl {
 public:
  Impl(const GigeParams& params, Sink sink)
      : params_(params), sink_(std::move(sink)), pairer_(1e-3 * params.stereo_tolerance_ms) {
    addCamera(params.camera, 0);
    if (!params.right_camera.empty()) {
      requireAnother(keepers_.front()->stats().settings);
      addCamera(params.right_camera, 1);
    }
    for (auto& keeper : keepers_) keeper->start();
  }
  ~Impl() { stop(); }

  void stop() {
    for (auto& keeper : keepers_) keeper->stop();
  }

  std::string failure() const {
    for (const auto& keeper : keepers_)
      if (auto why = keeper->failure(); !why.empty()) return why;
    return {};
  }

  GrabStats stats() const {
    GrabStats stats;
    for (const auto& keeper : keepers_) stats.cameras.push_back(keeper->stats());
    const std::lock_guard lock(mutex_);
    stats.frames = frames_;
    stats.unpaired = pairer_.unpaired();
    return stats;
  }

  std::vector<std::string> takeNotices() { return notices_.take(); }

 private:
  void addCamera(const std::string& id, int side) {
    keepers_.push_back(std::make_unique<Keeper>(
        params_, id, [this, side](Shot&& shot) { deliver(side, std::move(shot)); }, notices_));
  }

  /// An address and an id may mean the same camera, which is known when the left one has answered. Those
  /// without an address are Aravis' own, of which there are as many as are opened.
  void requireAnother(const CameraSettings& left) const {
    const std::string& right = params_.right_camera;
    if (left.address.empty()) return;
    const auto cameras = discover();
    const bool same =
        right == left.address || std::any_of(cameras.begin(), cameras.end(), [&](const CameraInfo& c) {
          return c.id == right && c.address == left.address;
        });
    if (same)
      throw base::ConfigError("right_camera: '" + right + "' is the left camera too; name another one");
  }

  void deliver(int side, Shot&& shot) {
    const std::lock_guard oneAtATime(delivery_);
    types::Frame frame;
    frame.label = params_.sensor_label;
    frame.stamp = shot.stamp;
    {
      const std::lock_guard lock(mutex_);
      if (keepers_.size() == 1) {
        frame.image = std::move(shot.image);
      } else {
        auto pair = pairer_.push(side, shot.stamp, std::move(shot.image));
        if (!pair) return;
        frame.stamp = pair->stamp;
        frame.image = std::move(pair->left);
        frame.right = std::move(pair->right);
      }
      frame.index = frames_++;
    }
    sink_(std::move(frame));
  }

  const GigeParams params_;
  Sink sink_;
  Notices notices_;
  std::mutex delivery_;  // frames leave one after the other
  mutable std::mutex mutex_;
  StereoPairer<cv::Mat> pairer_;  // under mutex_
  std::uint64_t frames_ = 0;      // under mutex_
  std::vector<std::unique_ptr<Keeper>> keepers_;
};

GigeGrabber::GigeGrabber(const GigeParams& params, Sink sink) {
  base::validate(params);
  impl_ = std::make_unique<Impl>(params, std::move(sink));
}
GigeGrabber::~GigeGrabber() = default;
void GigeGrabber::stop() { impl_->stop(); }
std::string GigeGrabber::failure() const { return impl_->failure(); }
GrabStats GigeGrabber::stats() const { return impl_->stats(); }
std::vector<std::string> GigeGrabber::takeNotices() { return impl_->takeNotices(); }

}  // namespace engram::capture

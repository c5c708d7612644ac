// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/live_source.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/capture/gige_grabber.h"
#include "engram/capture/odometry_feed.h"
#include "engram/capture/sensor_reader.h"

#include <mrpt/obs/CObservationOdometry.h>

#include <chrono>

namespace engram::capture {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceForOdometry = 5s;  // at the start

}  // namespace

QueueChoice queueFor(const GigeParams& params, bool recording) {
  const int capacity = params.queue > 0 ? params.queue : recording ? 32 : 2;
  const bool block = params.when_full == "auto" ? recording : params.when_full == "block";
  return {static_cast<std::size_t>(capacity), block ? WhenFull::kBlock : WhenFull::kDropOldest};
}

class LiveSource::Impl {
 public:
  Impl(const LiveConfig& config, std::function<bool()> stopped)
      : params_(config.camera),
        stopped_(std::move(stopped)),
        queue_(queueFor(params_, false).capacity, queueFor(params_, false).whenFull) {
    if (!config.odometry.empty())
      reader_ = std::make_unique<SensorReader>(params_.odometry, config.odometry,
                                               [this](const SensorReader::Object& object) { take(object); });
    grabber_ = std::make_unique<GigeGrabber>(params_,
                                             [this](types::Frame&& frame) { queue_.push(std::move(frame)); });
  }
  ~Impl() { queue_.close(); }

  std::optional<types::Frame> next() {
    while (!stopped_()) {
      auto frame = queue_.pop(50ms);
      if (!frame && !grabber_->failure().empty()) return std::nullopt;
      if (!frame || (reader_ && !addOdometry(*frame))) continue;
      frame->index = frames_++;
      return frame;
    }
    return std::nullopt;
  }

  std::string failure() const { return grabber_->failure(); }

  LiveStats stats() const {
    return {grabber_->stats(), queue_.counters(), queue_.size(), withoutOdometry_, feed_.leftOut()};
  }

  std::vector<std::string> takeNotices() {
    auto notices = grabber_->takeNotices();
    if (reader_ && !odometryHasFailed_ && !reader_->failure().empty()) {
      odometryHasFailed_ = true;
      notices.push_back(reader_->failure() + "; going on without");
    }
    return notices;
  }

 private:
  void take(const SensorReader::Object& object) {
    const auto odometry = std::dynamic_pointer_cast<mrpt::obs::CObservationOdometry>(object);
    if (!odometry) return;
    const auto& pose = odometry->odometry;
    feed_.add(mrpt::Clock::toDouble(odometry->timestamp), {pose.x(), pose.y(), pose.phi()});
  }

  /// False for an image before the first reading: the robot begins where odometry does.
  bool addOdometry(types::Frame& frame) {
    const auto pose = feed_.at(frame.stamp, params_.odometry_hold,
                               std::chrono::duration<double>(1e-3 * params_.odometry_wait_ms));
    if (pose) frame.T_odom_robot = types::toIsometry(*pose);
    if (feed_.readings() > 0) return true;
    ++withoutOdometry_;
    if (Clock::now() - start_ > kPatienceForOdometry)
      throw base::Error("[" + params_.odometry + "] gives no odometry" +
                        (reader_->failure().empty() ? "" : ": " + reader_->failure()));
    return false;
  }

  const GigeParams params_;
  std::function<bool()> stopped_;
  BoundedQueue<types::Frame> queue_;
  OdometryFeed feed_;
  std::size_t frames_ = 0, withoutOdometry_ = 0;
  bool odometryHasFailed_ = false;
  const Clock::time_point start_ = Clock::now();
  std::unique_ptr<SensorReader> reader_;  // these two last: their threads end first
  std::unique_ptr<GigeGrabber> grabber_;
};

LiveSource::LiveSource(const LiveConfig& config, std::function<bool()> stopped)
    : impl_(std::make_unique<Impl>(config, std::move(stopped))) {}
LiveSource::~LiveSource() = default;
std::optional<types::Frame> LiveSource::next() { return impl_->next(); }
std::string LiveSource::failure() const { return impl_->failure(); }
LiveStats LiveSource::stats() const { return impl_->stats(); }
std::vector<std::string> LiveSource::takeNotices() { return impl_->takeNotices(); }

std::string LiveSource::problem() const {
  const LiveStats s = stats();
  std::string text = failure();
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (s.queue.dropped > 0)
    add(std::to_string(s.queue.dropped) + " of " + std::to_string(s.queue.pushed) +
        " images were dropped to keep up with the camera; a lower frame_rate saves processor time");
  if (s.grab.lost() > 0) {
    add("lost: " + base::counted(s.grab.lost(), "image"));
    const std::string advice = adviceOnLoss(s.grab);
    if (!advice.empty()) add(advice);
  }
  if (s.odometryLeftOut > 0)
    add(base::counted(s.odometryLeftOut, "odometry reading") +
        " left out: not a number, or further than 20000 km");
  return text;
}

}  // namespace engram::capture

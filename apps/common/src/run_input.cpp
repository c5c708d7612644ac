// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_input.h"

#include "engram/apps/checks.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/text.h"

#include <nlohmann/json.hpp>

#include <iomanip>
#include <ostream>
#include <sstream>

namespace engram::apps {
namespace {

constexpr double kGrace = 2.0;  // [s]
constexpr auto kFlushEvery = std::chrono::milliseconds(500);

double now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

void RunInput::declare(CLI::App& app) {
  offline_.declare(app);
  app.add_option("--record", recordPath_,
                 "With --live: record what is processed to this rawlog; its replay gives "
                 "the same result")
      ->type_name("FILE");
  app.add_flag("--overwrite-record", overwriteRecord_, "Replace that rawlog if it exists");
  app.add_option("--seconds", seconds_, "With --live: stop after so long; default: at Ctrl-C")
      ->check(positive());
}

void RunInput::open(RunConfig& config, std::ostream& notices) {
  if (offline_.isOpen() || live_) return;
  notices_ = &notices;
  const bool wantsLive = !config.liveSection.empty();
  if (wantsLive && offline_.given())
    throw UsageError("--live, and --rawlog, --images or --video: give one of them");
  if (!wantsLive && (!recordPath_.empty() || seconds_ > 0))
    throw UsageError("--record and --seconds are for --live");
  if (!wantsLive) {
    offline_.open(config.source);
    const std::string notice = config.settleCamera(offline_);
    if (!notice.empty()) notices << base::forTerminal(notice) << "\n" << std::flush;
    return;
  }
  if (!recordPath_.empty()) {
    sources::RawlogWriterParams params;
    params.sensor_label = config.live.camera.sensor_label;
    params.live = true;
    params.sync = false;  // the images must not wait for the disk
    params.overwrite = overwriteRecord_;
    recorder_ = std::make_unique<sources::RawlogWriter>(recordPath_, params);
    lastFlush_ = std::chrono::steady_clock::now();
  }
  live_ = std::make_unique<capture::LiveSource>(config.live,
                                                [this] { return base::interrupted() || isOverdue(); });
}

std::string RunInput::source(const RunConfig& config) const {
  return offline_.given() ? offline_.name() : config.liveSection;
}

std::optional<types::Frame> RunInput::next() {
  if (base::interrupted()) return std::nullopt;
  if (offline_.isOpen()) return offline_.next();
  auto frame = live_->next();
  passOn();
  if (!frame || timeIsUp(*frame)) return std::nullopt;
  if (recorder_) record(*frame);
  return frame;
}

bool RunInput::timeIsUp(const types::Frame& frame) {
  if (!firstStamp_) {
    firstStamp_ = frame.stamp;
    begun_ = std::chrono::steady_clock::now();
  }
  return seconds_ > 0 && frame.stamp - *firstStamp_ >= seconds_;
}

/// The time is up by the clock, but no image has come that says so: the camera is lost.
bool RunInput::isOverdue() const {
  if (seconds_ <= 0 || !firstStamp_) return false;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count() > seconds_ + kGrace;
}

void RunInput::passOn() {
  for (const auto& notice : live_->takeNotices())
    *notices_ << base::forTerminal(notice) << "\n" << std::flush;
}

/// A full disk ends the recording, not the work of the robot.
void RunInput::record(types::Frame& frame) {
  try {
    frame = recorder_->addReplayable(frame);
    const auto time = std::chrono::steady_clock::now();
    if (time - lastFlush_ < kFlushEvery) return;
    lastFlush_ = time;
    recorder_->flush();
  } catch (const base::Error& e) {
    recordFailure_ = std::string(e.what()) + "; " + std::to_string(recorder_->framesSafe()) +
                     " images were recorded, the run goes on without recording";
    *notices_ << recordFailure_ << "\n" << std::flush;
    recorded_ = recorder_->framesSafe();
    recorder_.reset();
  }
}

void RunInput::close() {
  if (!recorder_) return;
  recorder_->close();
  recorded_ = recorder_->framesSafe();
  recorder_.reset();
}

double RunInput::progress() const { return offline_.isOpen() ? offline_.progress() : live_->progress(); }

void RunInput::annotate(types::FrameReport& report) {
  if (!live_) return;
  const capture::LiveStats stats = live_->stats();
  auto& state = report.live.emplace();
  state.latency = 1e3 * (now() - report.stamp);
  state.waiting = stats.waiting;
  state.incomplete = stats.grab.incomplete();
  state.missed = stats.grab.missed();
  state.dropped = stats.queue.dropped;
  latencies_.add(state.latency);
}

std::string RunInput::problem() const { return offline_.isOpen() ? offline_.problem() : live_->problem(); }

ExitCode RunInput::exitCode() const {
  if (offline_.isOpen()) return offline_.whole() && !base::interrupted() ? kOk : kPartial;
  const bool cutShort = base::interrupted() && seconds_ > 0;
  return live_->failure().empty() && recordFailure_.empty() && !cutShort ? kOk : kPartial;
}

nlohmann::json RunInput::figures() const {
  if (!live_) return nullptr;
  const capture::LiveStats stats = live_->stats();
  const evaluation::Percentiles ms = latencies_.summary();
  return {{"latency_ms", {{"mean", ms.mean}, {"median", ms.median}, {"p95", ms.p95}, {"max", ms.max}}},
          {"captured", stats.queue.pushed},
          {"dropped", stats.queue.dropped},
          {"incomplete", stats.grab.incomplete()},
          {"missed", stats.grab.missed()},
          {"unpaired", stats.grab.unpaired},
          {"reconnects", stats.grab.reconnects()},
          {"without_odometry", stats.withoutOdometry},
          {"queue_longest", stats.queue.longest},
          {"recorded", recorded_}};
}

std::string RunInput::summary() const {
  if (!live_) return {};
  const evaluation::Percentiles ms = latencies_.summary();
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "  " << ms.mean
       << " ms from exposure to belief (95 %: " << ms.p95 << ", max: " << ms.max << ")\n";
  return text.str();
}

}  // namespace engram::apps

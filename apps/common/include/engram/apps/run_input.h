// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/offline_input.h"
#include "engram/apps/run_config.h"
#include "engram/capture/live_source.h"
#include "engram/evaluation/running_percentiles.h"
#include "engram/sources/rawlog_writer.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <nlohmann/json_fwd.hpp>

#include <chrono>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

namespace engram::apps {

/// The images of a run: of a rawlog, of files, of a video, or of a live camera. A live run can be recorded;
/// it then works on the images as the rawlog holds them, so that the replay gives the same result to the last
/// bit.
class RunInput {
 public:
  void declare(CLI::App& app);
  bool live() const { return live_ != nullptr; }
  bool given(const RunConfig& config) const { return offline_.given() || !config.liveSection.empty(); }
  /// What the images are read from; empty for a live camera.
  const std::string& path() const { return offline_.path(); }

  /// Opens once, and settles the calibration in `config`: another call does nothing.
  /// @param notices takes messages while the run is under way
  /// Throws base::Error for bad options, and as openRawlog() and LiveSource.
  void open(RunConfig& config, std::ostream& notices);
  /// The file name of the images, or the name of the live camera's section.
  std::string source(const RunConfig& config) const;
  /// The image that next() will return first; null when there is none. Not for live cameras.
  const types::Frame* peek() { return offline_.peek(); }
  /// None at the end, after Ctrl-C, and after --seconds.
  std::optional<types::Frame> next();
  double progress() const;
  /// Adds what only a live run knows; to be called as soon as the belief is known.
  void annotate(types::FrameReport& report);

  /// What was lost or is wrong; empty when nothing is. To be asked after the end.
  std::string problem() const;
  /// kOk when all went as wished: a live run that is ended by Ctrl-C did, unless --seconds was given.
  ExitCode exitCode() const;
  /// Null for a rawlog; keys: latency_ms {mean, median, p95, max}, captured, dropped, incomplete, missed,
  /// unpaired, reconnects, without_odometry, queue_longest, recorded.
  nlohmann::json figures() const;
  /// One line for a person; empty for a rawlog.
  std::string summary() const;
  /// Ends a recording.
  void close();

 private:
  void record(types::Frame& frame);
  void passOn();
  bool timeIsUp(const types::Frame& frame);
  bool isOverdue() const;

  OfflineInput offline_;
  std::string recordPath_;
  double seconds_ = 0.0;
  bool overwriteRecord_ = false;

  std::unique_ptr<capture::LiveSource> live_;
  std::unique_ptr<sources::RawlogWriter> recorder_;
  std::string recordFailure_;
  std::size_t recorded_ = 0;
  std::chrono::steady_clock::time_point lastFlush_;
  std::optional<double> firstStamp_;
  std::chrono::steady_clock::time_point begun_;  // when the first image was there
  evaluation::RunningPercentiles latencies_;     // [ms]
  std::ostream* notices_ = nullptr;
};

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/capture/bounded_queue.h"
#include "engram/capture/grab_stats.h"
#include "engram/capture/live_config.h"
#include "engram/sources/frame_source.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace engram::capture {

/// The queue between camera and program that a configuration asks for.
struct QueueChoice {
  std::size_t capacity;
  WhenFull whenFull;
};
QueueChoice queueFor(const GigeParams& params, bool recording);

struct LiveStats {
  GrabStats grab;
  QueueCounters queue;
  std::size_t waiting = 0;          ///< images in the queue now
  std::size_t withoutOdometry = 0;  ///< left out at the start, before the first reading of odometry
  std::size_t odometryLeftOut = 0;  ///< readings that are not numbers, or more than a robot can do
};

/// Images of a camera as they are taken, with odometry if there is any. Threads of their own receive both;
/// the queue between them and next() is bounded.
class LiveSource final : public sources::FrameSource {
 public:
  /// @param stopped asked often; when true, next() gives no more images
  /// Throws base::Error when camera or odometry cannot be started.
  LiveSource(const LiveConfig& config, std::function<bool()> stopped);
  ~LiveSource() override;

  /// Waits for the next image; none when stopped, or when the camera is lost for good. Throws base::Error
  /// when the sensor of odometry gives nothing from the start.
  std::optional<types::Frame> next() override;
  double progress() const override { return -1.0; }
  /// What was lost, and which setting helps.
  std::string problem() const override;

  /// Why no more images come, other than that it was stopped; empty otherwise.
  std::string failure() const;
  LiveStats stats() const;
  /// What happened since the last call, as messages for the user.
  std::vector<std::string> takeNotices();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::capture

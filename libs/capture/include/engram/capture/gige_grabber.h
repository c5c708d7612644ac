// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/capture/gige_params.h"
#include "engram/capture/grab_stats.h"
#include "engram/types/frame.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace engram::capture {

/// Receives the images of one GigE Vision camera, or the pairs of two, until it is destroyed. A camera that
/// is lost is connected again, with growing pauses. Incomplete images are dropped and counted.
///
/// The stamp of a frame is the camera's own, taken to the host's clock (ClockMap), or the time of arrival for
/// a camera without a clock. A pair has the stamp of the left image.
class GigeGrabber {
 public:
  /// Called from a thread of the grabber, one frame at a time; may block.
  using Sink = std::function<void(types::Frame&&)>;

  /// Connects and starts. Throws base::Error when a camera is not there, is in use, or refuses a setting.
  GigeGrabber(const GigeParams& params, Sink sink);
  ~GigeGrabber();
  GigeGrabber(const GigeGrabber&) = delete;
  GigeGrabber& operator=(const GigeGrabber&) = delete;

  /// No frame comes after this returns.
  void stop();

  /// Why no more images will come, as a message for the user; empty while they may.
  std::string failure() const;
  GrabStats stats() const;
  /// What happened since the last call, as messages for the user: a camera was lost, or is back.
  std::vector<std::string> takeNotices();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::capture

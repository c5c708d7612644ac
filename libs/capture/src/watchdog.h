// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

namespace engram::capture {

struct WatchdogParams {
  double silence = 2.0;       ///< without a frame for so long the camera counts as lost [s]; 0: never
  double firstDelay = 0.5;    ///< before the first attempt to connect again [s]; doubles with every failure
  double longestDelay = 8.0;  ///< [s]
  double giveUp = 0.0;        ///< after so long without a frame [s]; 0: never
};

/// Decides when a camera is lost and when to try it again. Knows no clock: times are told, in seconds of any
/// steady clock.
class Watchdog {
 public:
  enum class Advice {
    kWait,     ///< frames are coming, or it is too early to try again
    kConnect,  ///< not connected: try now, and tell the outcome by connected() or failed()
    kDrop,     ///< connected but silent for too long: close the connection, and tell lost()
    kGiveUp,
  };

  Watchdog(const WatchdogParams& params, double now) : params_(params), lastSign_(now) {}

  void connected(double now);
  void frame(double now);
  void lost(double now);
  void failed(double now);

  Advice advice(double now) const;
  /// When the camera was lost [s]; none while it is connected.
  std::optional<double> lostSince() const { return lostSince_; }

 private:
  WatchdogParams params_;
  double lastSign_;  // of life: connected, or the last frame
  double lastFrame_ = 0.0;
  bool isConnected_ = false;
  bool hadFrame_ = false;
  std::optional<double> lostSince_;
  double delay_ = 0.0, nextAttempt_ = 0.0;
};

}  // namespace engram::capture

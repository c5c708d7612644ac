// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "watchdog.h"

#include <algorithm>

namespace engram::capture {

void Watchdog::connected(double now) {
  isConnected_ = true;
  lastSign_ = now;
}

/// Only a frame proves that the camera is back: a connection that brings none must not shorten the delays.
void Watchdog::frame(double now) {
  lastSign_ = lastFrame_ = now;
  hadFrame_ = true;
  lostSince_.reset();
  delay_ = 0.0;
}

void Watchdog::lost(double now) {
  if (!lostSince_) lostSince_ = hadFrame_ ? lastFrame_ : now;
  failed(now);
}

void Watchdog::failed(double now) {
  isConnected_ = false;
  if (!lostSince_) lostSince_ = now;
  delay_ = delay_ == 0.0 ? params_.firstDelay : std::min(2.0 * delay_, params_.longestDelay);
  nextAttempt_ = now + delay_;
}

Watchdog::Advice Watchdog::advice(double now) const {
  if (params_.giveUp > 0.0 && lostSince_ && now - *lostSince_ >= params_.giveUp) return Advice::kGiveUp;
  if (!isConnected_) return now >= nextAttempt_ ? Advice::kConnect : Advice::kWait;
  const bool silent = params_.silence > 0.0 && now - lastSign_ >= params_.silence;
  return silent ? Advice::kDrop : Advice::kWait;
}

}  // namespace engram::capture

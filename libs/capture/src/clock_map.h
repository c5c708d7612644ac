// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace engram::capture {

/// Takes the stamps of a camera's own clock to the clock of the host.
///
/// A frame arrives after a delay that is never less than the way through the network, and now and then much
/// more. So the line from camera to host time lies below all arrivals and touches some: of the edges of the
/// lower convex hull of the arrivals it is the one that is nearest to all of them, which is the one below
/// their mean (Zhang, Liu & Xia, INFOCOM 2002). Late frames, however many, do not move it. The hull is that
/// of the quickest arrival of each second in the last two minutes; memory is constant.
///
/// What cannot be seen from one side is the least delay itself: host stamps are late by it (some 0.1 ms on a
/// local network, more where the camera stamps the end of the exposure).
class ClockMap {
 public:
  /// @param device stamp of the frame by the camera [ns]; must rise, or else the camera was started anew
  /// @param arrival when the frame began to arrive, by the host [ns since the Unix epoch]
  /// @return the stamp by the clock of the host [ns since the Unix epoch]; rises from call to call
  std::int64_t toHost(std::int64_t device, std::int64_t arrival);

  /// Forgets everything: the camera was started anew.
  void restart();

  double drift() const { return drift_; }             ///< how much faster the host's clock runs [s/s]
  std::size_t restarts() const { return restarts_; }  ///< times that the relation was lost and begun anew

 private:
  struct Arrival {
    double device;  ///< since origin_ [s]
    double delay;   ///< arrival - device, as far as it exceeds that of the first frame [s]
  };
  void begin(std::int64_t device, std::int64_t arrival);
  bool contradicts(const Arrival& arrival);
  void add(const Arrival& arrival);
  void fit();
  double predicted(double device) const { return offset_ + drift_ * device; }

  bool running_ = false;
  std::int64_t deviceOrigin_ = 0, hostOrigin_ = 0;
  std::int64_t lastDevice_ = 0, lastHost_ = 0;
  std::deque<Arrival> quickest_;  // of each second
  double offset_ = 0.0, drift_ = 0.0;
  int late_ = 0;  // arrivals in a row that are later than any network explains
  std::size_t restarts_ = 0;
};

}  // namespace engram::capture

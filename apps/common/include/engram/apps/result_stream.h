// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/frame_report.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace engram::apps {

/// Where an image was taken, for other programs.
struct StreamPose {
  Eigen::Vector3d position;       ///< in the map frame [m]
  std::optional<double> heading;  ///< [rad]; none when it is not known
};

/// One line of the stream, without line break: an object with the keys
///
///     index, stamp [s], outcome (as in FrameReport), place, best_guess (null when there is none),
///     pose {x, y, z [m], heading_deg (null when unknown), and where FrameReport::pose is known the standard
///     deviations sigma_along, sigma_across [m], sigma_heading_deg} or null, belief [{place, probability}]
///     best first, new_place (probability), inliers (null when nothing was verified), latency_ms (null for a
///     rawlog), and accepted_by (geometry, sequence) where a place was accepted
std::string streamLine(const types::FrameReport& report, const std::optional<StreamPose>& pose);

/// Lines for other programs, on standard output or to all that connect to a Unix socket. A reader that is
/// slow or stuck misses lines; it never holds up the writer.
class ResultStream {
 public:
  /// @param target "-" is standard output; else the path of the socket, which is made, and removed at the end
  /// @param hello first line for each reader
  /// Throws base::Error when the path exists and is no abandoned socket, or cannot be used.
  ResultStream(const std::string& target, const std::string& hello);
  ~ResultStream();
  ResultStream(const ResultStream&) = delete;
  ResultStream& operator=(const ResultStream&) = delete;

  /// Gives readers half a second to take what is left; the destructor does the same.
  void finish();

  /// Returns at once.
  void send(const std::string& line);

  std::size_t readers() const;
  /// Lines that some reader missed.
  std::size_t missed() const;
  /// Why standard output takes no lines, such as a full disk; empty when it does, or when its reader has
  /// gone.
  std::string failure() const;

  /// How many are served at a time: the system's limit on open files, less what the run needs itself.
  std::size_t mostReaders() const;
  /// How often a reader was found waiting for whom there was no room, or no descriptor. It is served when
  /// another one goes.
  std::size_t postponed() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::apps

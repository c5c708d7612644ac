// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/world/world.h"

#include <memory>
#include <string>

namespace engram::apps {

enum class RawlogLayout {
  kObservations,  ///< CObservationOdometry at the rate of the wheels, and images, in order of time
  kActions,       ///< for each image one CActionRobotMovement2D since the image before and one CSensoryFrame
};

/// Writes the rawlog of a simulated session with MRPT's classes, calibration and camera pose included. The
/// file gets its name in close(); without it nothing is left behind.
class RawlogFile {
 public:
  /// Throws base::Error when the file cannot be written.
  RawlogFile(const std::string& path, const world::Session& session, RawlogLayout layout,
             bool externalImages);
  ~RawlogFile();
  RawlogFile(const RawlogFile&) = delete;
  RawlogFile& operator=(const RawlogFile&) = delete;

  /// Image i of the session; in order. Odometry up to it is written first.
  void add(std::size_t i, const types::Frame& frame);
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Where the images of a rawlog are when they are outside.
std::string imagesFolder(const std::string& rawlog);

}  // namespace engram::apps

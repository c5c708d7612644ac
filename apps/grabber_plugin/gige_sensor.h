// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/capture/bounded_queue.h"
#include "engram/capture/gige_grabber.h"
#include "engram/types/frame.h"

#include <mrpt/hwdrivers/CGenericSensor.h>

#include <memory>

namespace engram::apps {

/// Our GigE Vision camera as a sensor of MRPT: `rawlog-grabber -p libengram_gige_camera.so robot.ini` records
/// it beside all that MRPT knows. The section of the `.ini` file is the one that engram-slam --live takes; a
/// section
/// `.features` needs `rawlog-grabber-ignore = true`. Images lie in the rawlog as MRPT itself stores them.
class EngramGigECamera final : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(EngramGigECamera)

 public:
  EngramGigECamera() = default;
  ~EngramGigECamera() override;

  void initialize() override;
  /// Hands over all images that have come. Throws when the camera is lost for good.
  void doProcess() override;

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override;

 private:
  void hand(types::Frame&& frame);

  capture::GigeParams params_;
  std::unique_ptr<capture::BoundedQueue<types::Frame>> queue_;
  std::unique_ptr<capture::GigeGrabber> grabber_;  // last: its threads end first
};

}  // namespace engram::apps

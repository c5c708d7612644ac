// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"

#include <string>
#include <utility>
#include <vector>

namespace engram::capture {

/// The class of our plug-in for MRPT's rawlog-grabber.
inline constexpr const char* kGigeDriver = "EngramGigECamera";

/// The section of a live camera. Zero or empty keeps what the camera has.
struct GigeParams {
  std::string driver = kGigeDriver;
  std::string camera;
  std::string right_camera;
  std::string sensor_label = "CAMERA";
  std::string pixel_format;
  double exposure_us = 0.0;
  double gain = -1.0;
  double frame_rate = 0.0;
  int offset_x = 0, offset_y = 0, width = 0, height = 0;
  std::string trigger;
  int packet_size = 0;
  double packet_delay_us = 0.0;
  bool packet_socket = true;
  bool resend = true;
  double socket_buffer_mb = 16.0;
  int buffers = 16;
  int queue = 0;
  std::string when_full = "auto";
  double stereo_tolerance_ms = 5.0;
  double silence_s = 2.0;
  double give_up_s = 0.0;
  std::string odometry;
  double odometry_wait_ms = 100.0;
  double odometry_hold = 1.0;
  double process_rate = 50.0;
  int max_queue_len = 200, grab_decimation = 0;

  /// Any GenICam features by name, set after all others and in this order; from the section
  /// `<name>.features`.
  std::vector<std::pair<std::string, std::string>> features;

  void describe(base::Params& p);
};

/// Throws base::ConfigError when both names of a stereo pair are the same: it would wait for its own images.
void requireTwoCameras(const GigeParams& params);

}  // namespace engram::capture

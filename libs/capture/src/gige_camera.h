// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/capture/gige_params.h"
#include "engram/capture/grab_stats.h"
#include "gobject_ptr.h"

#include <opencv2/core/mat.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace engram::capture {

/// One connection to one camera, from opening it to losing it.
class GigeCamera {
 public:
  struct Grabbed {
    enum class Kind { kNothing, kWhole, kIncomplete };
    Kind kind = Kind::kNothing;
    cv::Mat image;             ///< of kWhole
    std::uint64_t number = 0;  ///< given by the camera
    std::int64_t device = 0;   ///< the camera's clock [ns]; 0 when it has none
    std::int64_t arrival = 0;  ///< the host's clock when the first packet came [ns since the Unix epoch]
  };

  /// Opens and configures `id` (empty: the only camera there is) and starts it. Throws base::Error that names
  /// camera, key and value, and what to do.
  GigeCamera(const GigeParams& params, const std::string& id);
  ~GigeCamera();
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;

  /// The next image, or nothing after `patience`. Triggers the camera when it is time, if that is our task.
  /// Throws base::Error when an image cannot be converted.
  Grabbed grab(std::chrono::microseconds patience);

  bool controlLost() const { return controlLost_; }
  /// The camera does not answer: the destructor need not stop it, which would take seconds.
  void abandon() { abandoned_ = true; }
  /// What the camera says of itself and how it is set.
  const CameraSettings& settings() const { return settings_; }
  /// Of this connection.
  PacketStats packets() const;

 private:
  void open(const std::string& id);
  void requireControl() const;
  void configure(const GigeParams& params);
  void configureRegion(const GigeParams& params);
  void configureTrigger(const GigeParams& params);
  void configureNetwork(const GigeParams& params);
  void requireFormat() const;
  std::string formats() const;  ///< that the camera and Engram know, for a message
  void readSettings();
  void startStream(const GigeParams& params);
  void triggerIfDue();
  /// Throws base::Error when `error` is set: "camera ID: KEY = VALUE is refused: …".
  void check(const GErrorBox& error, const std::string& key, const std::string& value) const;

  GObjectPtr<ArvCamera> camera_;
  GObjectPtr<ArvStream> stream_;
  ArvDevice* device_ = nullptr;  // owned by camera_
  gulong controlLostHandler_ = 0;
  std::atomic<bool> controlLost_{false};
  bool abandoned_ = false;
  CameraSettings settings_;
  std::chrono::steady_clock::duration triggerPeriod_{};  // 0: not our task
  std::chrono::steady_clock::time_point nextTrigger_;
};

}  // namespace engram::capture

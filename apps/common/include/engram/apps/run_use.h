// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/odometry/stereo_check.h"
#include "engram/pipeline/odometry_watch.h"
#include "engram/types/frame_report.h"

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <optional>
#include <string>

namespace engram::apps {

/// Of what use the images of a run were: counts those that could not be used or placed by their causes. A run
/// that mostly failed for one cause must not look like a success.
class RunUse {
 public:
  void add(const types::FrameReport& report);

  /// Not one image could be used: each was unusable or skipped.
  bool none() const { return images_ > 0 && used_ == 0; }
  /// The cause for which more than half of the images were unusable, or for which none could be used, with
  /// what to do; empty when there is no such cause. Refusals are a cause only when not one image was placed:
  /// that an image is not recognised is an answer of localisation, not a failure.
  std::string complaint() const;
  /// Throws base::Error with the complaint when none().
  void requireSome() const;

  /// A line for a person; empty when all images were of use.
  std::string summary() const;
  /// {cause: images} of the unusable and the refused ones.
  nlohmann::json toJson() const;

 private:
  using Counts = std::map<std::string, int>;

  int images_ = 0, used_ = 0, placed_ = 0;
  Counts causes_;   // of unusable and refused images
  Counts refused_;  // of the latter
  Counts skipped_;  // of images that were not looked at, such as of a robot that stands
};

/// The cause in a reason: what is measured there in one image or another is left out.
std::string causeIn(const std::string& reason);

/// Says once in a run that the eyes of a stereo camera are not in order.
class EyeWatch {
 public:
  /// To be called after each image, and once more after the `last` one.
  /// @param health none without a stereo camera
  /// @return the message, once, when the fault has stood for a while or the run is over; else empty
  std::string after(const std::optional<odometry::StereoHealth>& health, bool last = false);
  /// Whether there was a fault when after() was called last.
  bool faulty() const { return fault_ != odometry::StereoFault::kNone; }

 private:
  odometry::StereoFault fault_ = odometry::StereoFault::kNone;
  int pairs_ = 0;  // looked at when this fault was first found
  bool said_ = false;
};

/// {leaps, frozen, heading_ratio, …, fault} of wheel odometry; null for a run that had none.
nlohmann::json toJson(const pipeline::OdometryHealth& health);

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/bags/bag.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/sources/frame_source.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace engram::bags {

/// What to take from a bag. Empty names are chosen where the bag leaves no choice.
struct BagSourceParams {
  std::string image;       ///< topic of the (left) camera
  std::string right;       ///< topic of the right camera
  std::string odometry;    ///< topic of nav_msgs/Odometry; "tf": odom → base of the transforms; "none"
  std::string base_frame;  ///< of the robot; default: the child of the odometry, base_link or base_footprint
  double sync = 0.005;     ///< images of the two eyes that are no further apart are one pair [s]
};

/// The images of a bag as frames, with odometry interpolated to their stamps (those of the headers).
///
/// The bag is read twice: once for what stands still or comes later (calibrations, mounts, odometry), then
/// for the images. A camera's calibration is the first `camera_info` beside its topic; its mount the chain of
/// transforms from the robot's frame, each as it was first sent.
class BagSource : public sources::FrameSource {
 public:
  /// Calibration of the one camera, if it is known and can be used.
  virtual const std::optional<cameras::CameraRig>& camera() const = 0;
  /// Calibration of both eyes, if they are known and can be used.
  virtual const std::optional<cameras::StereoRig>& stereo() const = 0;
  /// What was chosen and what was not found, a sentence each.
  virtual const std::vector<std::string>& notes() const = 0;
  virtual std::size_t imagesUnusable() const = 0;  ///< that could not be decoded
  virtual std::size_t imagesUnpaired() const = 0;  ///< of one eye without the other
};

/// Throws base::Error when there is no image, a topic is not there or of another type, or there is a choice;
/// it lists the topics then.
std::unique_ptr<BagSource> openBagSource(const std::string& path, const BagSourceParams& params = {});

}  // namespace engram::bags

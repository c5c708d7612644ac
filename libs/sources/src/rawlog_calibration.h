// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/image_plane.h"
#include "engram/cameras/stereo_rig.h"

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include <cstdint>
#include <optional>
#include <span>

namespace engram::sources {

/// What an observation says about its camera.
struct RecordedCamera {
  cv::Size size;
  cameras::ImagePlaneParams plane;
  Eigen::Isometry3d T_robot_cam = Eigen::Isometry3d::Identity();
};

struct RecordedPair {
  RecordedCamera left, right;
};

/// The camera at the beginning of a CObservationImage (version 4) or of a CObservationStereoImages (5, 6;
/// both cameras at the same place: the pose of the right one stands behind the images). None when nobody
/// calibrated it, when it has a distortion that Engram does not know, and in older versions.
/// @param bytes of the object, from behind its header.
std::optional<RecordedCamera> recordedCamera(std::span<const std::uint8_t> bytes);
std::optional<RecordedPair> recordedPair(std::span<const std::uint8_t> bytes);

/// The last CPose3DQuat in the bytes: of a CObservationStereoImages it is T_left_right.
std::optional<Eigen::Isometry3d> lastPose(std::span<const std::uint8_t> bytes);

/// With the default mount where the pose is that of a camera nobody mounted: at the origin, looking up.
cameras::CameraRig toRig(const RecordedCamera& camera);
cameras::StereoRig toStereoRig(const RecordedCamera& left, const RecordedCamera& right);

}  // namespace engram::sources

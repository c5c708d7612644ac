// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/stereo_rig.h"
#include "engram/types/stereo.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

namespace engram::cameras {

/// Makes the rows of both images of a stereo camera correspond (cv::stereoRectify, no border left empty).
/// A rig that is rectified already is left as it is.
class Rectifier {
 public:
  /// Throws base::Error for a rig that cannot be rectified: other cameras than pinholes, images of different
  /// sizes, cameras above each other, or a right camera on the left.
  explicit Rectifier(const StereoRig& rig);

  /// The grey rectified images. Throws base::Error when an image is missing or has another size than the
  /// calibration.
  types::StereoPair operator()(const cv::Mat& left, const cv::Mat& right) const;

  /// True when nothing is to be done: parallel cameras with one camera matrix and no distortion.
  bool identity() const { return mapLeft_.empty(); }
  cv::Size imageSize() const { return size_; }
  const types::StereoModel& model() const { return model_; }
  /// Where the rectified left camera is on the robot.
  const Eigen::Isometry3d& T_robot_cam() const { return T_robot_cam_; }
  /// Of the rectified left image: CV_8U, 255 where the masks of both rigs allow.
  const cv::Mat& mask() const { return mask_; }

 private:
  void makeMaps(const StereoRig& rig);

  cv::Size size_;
  types::StereoModel model_;
  Eigen::Isometry3d T_robot_cam_ = Eigen::Isometry3d::Identity();
  cv::Mat mask_;
  cv::Mat mapLeft_, mapRight_;              // CV_16SC2, empty for the identity
  cv::Mat fractionsLeft_, fractionsRight_;  // CV_16UC1
};

}  // namespace engram::cameras

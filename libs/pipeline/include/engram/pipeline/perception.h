// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/appearance/panorama.h"
#include "engram/base/params.h"
#include "engram/cameras/camera_rig.h"
#include "engram/cameras/lifting_table.h"
#include "engram/cameras/pinhole.h"
#include "engram/cameras/rectifier.h"
#include "engram/features/extractor.h"
#include "engram/geometry/verify.h"
#include "engram/map/map_content.h"
#include "engram/odometry/row_matcher.h"
#include "engram/odometry/stereo_check.h"
#include "engram/odometry/visual_scan.h"
#include "engram/types/features.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"
#include "engram/types/rel_pose.h"
#include "engram/types/stereo.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace engram::pipeline {

/// Section `[camera]`.
struct CameraParams {
  std::string file;           ///< calibration file; empty: an uncalibrated pinhole with `fov`
  double fov = 1.0471975512;  ///< horizontal field of view of an uncalibrated camera [rad]
  int image_width = 0;        ///< images are scaled to this width before extraction [px]; 0 keeps them
  bool stereo = false;        ///< both eyes of a stereo camera: features have ranges
  int max_disparity = 128;    ///< stereo: largest disparity that is sought [px]

  void describe(base::Params& p);
};

/// See Perception::withOptics(). @param rig none: a pinhole camera, whose field of view does not matter here
geometry::VerifyParams withOptics(geometry::VerifyParams verify, const cameras::CameraRig* rig);

/// A rectified stereo camera on the robot.
struct StereoCamera {
  types::StereoModel model;
  Eigen::Isometry3d T_robot_cam = Eigen::Isometry3d::Identity();  ///< of the rectified left eye

  /// A motion of the robot from one of the left eye.
  types::RelPose ofRobot(const types::RelPose& T_eye_a_b) const;
};

/// Perceive: an image becomes features with quantised descriptors and unit bearings in the robot frame
/// (x forward, y left, z up), so that the vertical is the same for every camera (F-09, F-11). With
/// `[camera] stereo` the features are those of the rectified left image, with ranges where the right eye sees
/// them too, instead of bearings.
class Perception {
 public:
  /// Throws base::Error when the calibration cannot be read.
  Perception(CameraParams camera, const features::ExtractorParams& extractor);
  /// With a calibration at hand instead of a file.
  Perception(cameras::CameraRig rig, const features::ExtractorParams& extractor);

  /// Features of a frame. None, with outcome and reason in the report, for an image of another size or with
  /// fewer than `minFeatures` features. The first image fixes the size of an uncalibrated camera. Throws
  /// base::Error when the first image contradicts the calibration.
  std::optional<types::Features> look(const types::Frame& frame, int minFeatures, types::FrameReport& report);

  /// Why this image cannot be used, in words; empty when it can. Throws as look().
  std::string refusal(const cv::Mat& image);
  /// The same for the images of a frame: both of them with a stereo camera.
  std::string refusal(const types::Frame& frame);
  /// Features of an image that refusal() accepted.
  types::Features operator()(const cv::Mat& image) const;

  /// The stereo camera; none without `[camera] stereo`.
  const std::optional<StereoCamera>& stereo() const { return stereo_; }
  /// The rectified images of a frame that refusal() accepted, of a stereo camera.
  types::StereoPair rectified(const types::Frame& frame) const;
  /// The same, of the next frame of a drive: eyes() takes note of it.
  types::StereoPair lookWithBothEyes(const types::Frame& frame);
  /// Where the rectified left image may be used.
  const cv::Mat& rectifiedMask() const { return rectifier_->mask(); }
  /// Features of the left and of the right image, each by itself.
  std::pair<types::Features, types::Features> ofEachEye(const types::StereoPair& pair) const;
  /// Disparities of rectified images by correlation.
  odometry::RowMatcher rows(const types::StereoPair& pair) const { return {pair, params_.max_disparity}; }
  /// Features of rectified images, with ranges.
  types::Features operator()(const types::StereoPair& pair) const;

  /// Where the camera is on the robot, in the robot's frame [m]; at its origin when it is not calibrated.
  Eigen::Vector3d eye() const;

  /// The verification for this camera: `residual = conic` holds in the frame of its optics and with its
  /// mirror parameter, where [verify] conic_xi gives no other (F-E17). Throws base::ConfigError for a
  /// panorama, which has neither.
  geometry::VerifyParams withOptics(geometry::VerifyParams verify) const;

  /// How the camera is unwrapped; none for one that does not see all round or is not calibrated.
  std::optional<appearance::Panorama> panorama() const;

  /// What the pairs of the drive so far say of the eyes; none without a stereo camera.
  std::optional<odometry::StereoHealth> eyes() const;

  /// What a map made with this camera and extractor must be opened with again.
  map::MapHeader mapHeader(const std::string& memoryModel) const;

 private:
  std::string cameraText() const;
  void setRig(cameras::CameraRig rig);
  void setStereoRig(const cameras::StereoRig& rig);
  types::Features describe(const cv::Mat& image) const;

  CameraParams params_;
  std::unique_ptr<features::Extractor> extractor_;
  bool upright_;
  bool calibrated_;  // not by the approximation for an unknown camera
  std::optional<cameras::CameraRig> rig_;
  std::optional<cameras::Rectifier> rectifier_;
  std::optional<StereoCamera> stereo_;
  odometry::StereoCheck check_;
  std::string stereoText_;  // calibration of both eyes
  std::unique_ptr<cameras::LiftingTable> lifting_;
  Eigen::Matrix3f R_robot_cam_ = Eigen::Matrix3f::Identity();
  cv::Size expectedSize_;  // of the images as they come
  bool checkedFirst_ = false;
};

/// The visual scan of rectified images (V-01): points that both eyes see, with descriptors of the left one.
/// @param refine see ScansParams
types::Features scanOf(const Perception& perception, const types::StereoPair& pair,
                       const odometry::ScanParams& params, bool refine);

/// The features of a stereo view: the strongest whose range is known, at most so many (K-38).
types::Features viewFeatures(const Perception& perception, const types::StereoPair& pair, int most);

}  // namespace engram::pipeline

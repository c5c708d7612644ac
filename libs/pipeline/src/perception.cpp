// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/perception.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/cameras/unified_sphere.h"
#include "engram/types/se3.h"
#include "engram/types/size_text.h"
#include "step_timer.h"

#include <opencv2/imgproc.hpp>

namespace engram::pipeline {

void CameraParams::describe(base::Params& p) {
  p.add("file", file, "calibration file, relative to this one; empty: an uncalibrated pinhole camera");
  p.addDegrees("fov_deg", fov, "horizontal field of view of an uncalibrated camera [deg]", {10, 170});
  p.add("image_width", image_width, "images are scaled to this width before extraction [px]; 0 keeps them",
        {0, 8192});
  p.add(
      "stereo", stereo,
      "true: both eyes of the stereo camera that `file` describes are used, rectified; features get ranges");
  p.add("max_disparity", max_disparity, "stereo: largest disparity that is sought [px]", {8, 1024});
}

types::RelPose StereoCamera::ofRobot(const types::RelPose& T_eye_a_b) const {
  return types::seenBy(T_robot_cam, T_eye_a_b);
}

Perception::Perception(CameraParams camera, const features::ExtractorParams& extractor)
    : params_(std::move(camera)),
      extractor_(features::makeExtractor(extractor)),
      upright_(extractor.upright),
      calibrated_(!params_.file.empty()) {
  if (params_.stereo) {
    if (params_.file.empty() || !cameras::describesStereo(params_.file))
      throw base::ConfigError("[camera] stereo = true needs the calibration of a stereo camera, but file = " +
                              base::quoted(params_.file) +
                              " describes none; make one with `engram-rawlog calibrate --stereo`");
    if (params_.image_width != 0)
      throw base::ConfigError("[camera] image_width must be 0 with stereo = true");
    setStereoRig(cameras::loadStereoRig(params_.file));
  } else if (!params_.file.empty()) {
    setRig(cameras::loadCamera(params_.file));
  }
}

Perception::Perception(cameras::CameraRig rig, const features::ExtractorParams& extractor)
    : extractor_(features::makeExtractor(extractor)), upright_(extractor.upright), calibrated_(true) {
  setRig(std::move(rig));
}

void Perception::setRig(cameras::CameraRig rig) {
  expectedSize_ = rig.camera->imageSize();
  if (params_.image_width > 0 && params_.image_width != expectedSize_.width) {
    const double factor = static_cast<double>(params_.image_width) / expectedSize_.width;
    const int height = cvRound(expectedSize_.height * factor);
    rig.camera = rig.camera->scaled(factor, static_cast<double>(height) / expectedSize_.height);
    cv::resize(rig.mask, rig.mask, {params_.image_width, height}, 0, 0, cv::INTER_NEAREST);
  }
  R_robot_cam_ = rig.T_robot_cam.linear().cast<float>();
  lifting_ = std::make_unique<cameras::LiftingTable>(rig);
  rig_ = std::move(rig);
}

/// Both eyes as one rectified camera in the left one's place.
void Perception::setStereoRig(const cameras::StereoRig& rig) {
  rectifier_.emplace(rig);
  stereo_ = StereoCamera{rectifier_->model(), rectifier_->T_robot_cam()};
  stereoText_ = cameras::toText(rig);
  const types::StereoModel& m = stereo_->model;
  cameras::CameraRig left = cameras::makeRig(std::make_shared<cameras::Pinhole>(
      rectifier_->imageSize(), cameras::ImagePlaneParams{.fx = m.f, .fy = m.f, .cx = m.cx, .cy = m.cy}));
  left.T_robot_cam = stereo_->T_robot_cam;
  left.mask = rectifier_->mask();
  setRig(std::move(left));
  expectedSize_ = rig.left.camera->imageSize();
}

std::optional<types::Features> Perception::look(const types::Frame& frame, int minFeatures,
                                                types::FrameReport& report) {
  const StepTimer timer(report, "perceive");
  report.index = frame.index;
  report.stamp = frame.stamp;
  report.label = frame.label;
  report.outcome = types::Outcome::kUnusable;
  report.reason = refusal(frame);
  if (!report.reason.empty()) return std::nullopt;
  types::Features features = stereo_ ? (*this)(lookWithBothEyes(frame)) : (*this)(frame.image);
  report.features = static_cast<int>(features.size());
  if (report.features >= minFeatures) return features;
  report.reason = "too few features";
  return std::nullopt;
}

std::string Perception::refusal(const cv::Mat& image) {
  if (image.empty()) return "the image is empty";
  if (!rig_) setRig(cameras::makeRig(cameras::approximatePinhole(image.size(), params_.fov)));
  if (image.size() == expectedSize_) {
    checkedFirst_ = true;
    return {};
  }
  const std::string what = "the image is " + types::sizeText(image.size()) +
                           ", the camera of the configuration " + types::sizeText(expectedSize_);
  if (!checkedFirst_) throw base::Error(what + "; set [camera] file to the calibration of this camera");
  return what;
}

std::string Perception::refusal(const types::Frame& frame) {
  std::string reason = refusal(frame.image);
  if (!reason.empty() || !stereo_) return reason;
  if (frame.right.empty()) return "the right image of the stereo camera is missing";
  if (frame.right.size() != frame.image.size())
    return "the right image is " + types::sizeText(frame.right.size()) + ", the left one " +
           types::sizeText(frame.image.size());
  return {};
}

types::StereoPair Perception::lookWithBothEyes(const types::Frame& frame) {
  types::StereoPair pair = rectified(frame);
  check_.add(pair);
  return pair;
}

std::optional<odometry::StereoHealth> Perception::eyes() const {
  return stereo_ ? std::optional(check_.health()) : std::nullopt;
}

types::StereoPair Perception::rectified(const types::Frame& frame) const {
  return (*rectifier_)(frame.image, frame.right);
}

types::Features Perception::operator()(const types::StereoPair& pair) const {
  types::Features features = describe(pair.left);
  features.bearings.clear();  // pixels and ranges tell the points
  const odometry::RowMatcher matcher = rows(pair);
  for (const auto& k : features.keypoints) {
    const auto d = matcher.disparity(k.x, k.y);
    features.ranges.push_back(d ? types::rangeOf({k.x, k.y, *d}, stereo_->model) : 0.0f);
  }
  return features;
}

std::pair<types::Features, types::Features> Perception::ofEachEye(const types::StereoPair& pair) const {
  types::Features left = describe(pair.left);
  left.bearings.clear();
  types::Features right = extractor_->extract(pair.right, {});
  right.descriptors = types::quantised(right.descriptors);
  return {std::move(left), std::move(right)};
}

types::Features Perception::operator()(const cv::Mat& image) const { return describe(image); }

types::Features Perception::describe(const cv::Mat& image) const {
  cv::Mat scaled = image;
  const cv::Size size = lifting_->imageMask().size();
  if (image.size() != size) cv::resize(image, scaled, size, 0, 0, cv::INTER_AREA);
  types::Features features = extractor_->extract(scaled, lifting_->imageMask());
  features.descriptors = types::quantised(features.descriptors);
  features.bearings = lifting_->bearings(features.keypoints);
  for (auto& bearing : features.bearings) bearing = R_robot_cam_ * bearing;
  return features;
}

std::string Perception::cameraText() const {
  if (stereo_) return stereoText_;
  if (calibrated_) return cameras::toText(*rig_);
  return "uncalibrated pinhole, fov_deg = " + std::to_string(params_.fov * (180.0 / 3.14159265358979323846)) +
         ", image_width = " + std::to_string(params_.image_width);
}

Eigen::Vector3d Perception::eye() const {
  return rig_ ? Eigen::Vector3d(rig_->T_robot_cam.translation()) : Eigen::Vector3d::Zero();
}

geometry::VerifyParams withOptics(geometry::VerifyParams verify, const cameras::CameraRig* rig) {
  if (verify.residual != "conic" || !verify.R_optics_ray.isIdentity()) return verify;  // or known already
  const cameras::Camera* camera = rig ? rig->camera.get() : nullptr;
  const auto* mirror = dynamic_cast<const cameras::UnifiedSphere*>(camera);
  if (camera && !mirror && !dynamic_cast<const cameras::Pinhole*>(camera))
    throw base::ConfigError(
        "[verify] residual = conic needs a camera with a mirror or a lens, not a panorama");
  if (verify.conic_xi == 0 && mirror) verify.conic_xi = mirror->xi();
  const Eigen::Isometry3d T_robot_cam = rig ? rig->T_robot_cam : cameras::defaultMount("pinhole");
  verify.R_optics_ray = T_robot_cam.linear().transpose();
  return verify;
}

geometry::VerifyParams Perception::withOptics(geometry::VerifyParams verify) const {
  return pipeline::withOptics(std::move(verify), rig_ ? &*rig_ : nullptr);
}

std::optional<appearance::Panorama> Perception::panorama() const {
  return rig_ && !stereo_ ? appearance::Panorama::of(*rig_) : std::nullopt;
}

map::MapHeader Perception::mapHeader(const std::string& memoryModel) const {
  map::MapHeader header;
  header.engramVersion = ENGRAM_VERSION;
  header.camera = cameraText();
  header.extractor = extractor_->name() + (upright_ ? " upright" : "");
  const auto kind = extractor_->kind();
  header.descriptorKind = kind == types::DescriptorKind::kFloat ? types::DescriptorKind::kInt8 : kind;
  header.descriptorDim = extractor_->dim();
  header.memoryModel = memoryModel;
  return header;
}

types::Features scanOf(const Perception& perception, const types::StereoPair& pair,
                       const odometry::ScanParams& params, bool refine) {
  constexpr int kReach = 2;  // [px] that keypoints may be off
  const types::StereoModel& model = perception.stereo()->model;
  const auto [left, right] = perception.ofEachEye(pair);
  types::Features scan = odometry::makeScan(left, right, model, params);
  if (!refine) return scan;
  const odometry::RowMatcher rows = perception.rows(pair);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const types::Keypoint& k = scan.keypoints[i];
    const auto seen = static_cast<float>(types::stereoPoint(k, scan.ranges[i], model).disparity);
    if (const auto d = rows.disparity(k.x, k.y, seen, kReach))
      scan.ranges[i] = types::rangeOf({k.x, k.y, *d}, model);
  }
  return scan;
}

types::Features viewFeatures(const Perception& perception, const types::StereoPair& pair, int most) {
  const types::Features all = perception(pair);
  std::vector<int> kept;
  for (std::size_t i = 0; i < all.size() && kept.size() < static_cast<std::size_t>(most); ++i)
    if (all.ranges[i] > 0) kept.push_back(static_cast<int>(i));
  return all.subset(kept);
}

}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/perception.h"

#include "engram/base/error.h"
#include "step_timer.h"

#include <opencv2/imgproc.hpp>

namespace engram::pipeline {
namespace {

std::string sizeText(cv::Size size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

}  // namespace

void CameraParams::describe(base::Params& p) {
  p.add("file", file, "calibration file, relative to this one; empty: an uncalibrated pinhole camera");
  p.addDegrees("fov_deg", fov, "horizontal field of view of an uncalibrated camera [deg]", {10, 170});
  p.add("image_width", image_width, "images are scaled to this width before extraction [px]; 0 keeps them",
        {0, 8192});
}

Perception::Perception(CameraParams camera, const features::ExtractorParams& extractor)
    : params_(std::move(camera)),
      extractor_(features::makeExtractor(extractor)),
      upright_(extractor.upright),
      calibrated_(!params_.file.empty()) {
  if (!params_.file.empty()) setRig(cameras::loadCamera(params_.file));
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

std::optional<types::Features> Perception::look(const types::Frame& frame, int minFeatures,
                                                types::FrameReport& report) {
  const StepTimer timer(report, "perceive");
  report.index = frame.index;
  report.stamp = frame.stamp;
  report.label = frame.label;
  report.outcome = types::Outcome::kUnusable;
  report.reason = refusal(frame.image);
  if (!report.reason.empty()) return std::nullopt;
  types::Features features = (*this)(frame.image);
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
  const std::string what = "the image is " + sizeText(image.size()) + ", the camera of the configuration " +
                           sizeText(expectedSize_);
  if (!checkedFirst_) throw base::Error(what + "; set [camera] file to the calibration of this camera");
  return what;
}

types::Features Perception::operator()(const cv::Mat& image) const {
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
  if (calibrated_) return cameras::toText(*rig_);
  return "uncalibrated pinhole, fov_deg = " + std::to_string(params_.fov * (180.0 / 3.14159265358979323846)) +
         ", image_width = " + std::to_string(params_.image_width);
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

}  // namespace engram::pipeline

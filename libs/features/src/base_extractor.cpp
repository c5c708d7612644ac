// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base_extractor.h"

#include "engram/base/error.h"
#include "selection.h"

#include <opencv2/imgproc.hpp>

namespace engram::features {
namespace {

constexpr double kThresholdStep = 0.25;
// Below this no detector has a scale space of even one level.
constexpr int kSmallestSide = 24;

std::string sizeText(const cv::Mat& m) { return std::to_string(m.cols) + "x" + std::to_string(m.rows); }

cv::Mat toGrey(const cv::Mat& image) {
  if (image.empty()) return {};
  cv::Mat grey;
  switch (image.type()) {
    case CV_8UC1:
      return image;
    case CV_8UC3:
      cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
      return grey;
    case CV_8UC4:
      cv::cvtColor(image, grey, cv::COLOR_BGRA2GRAY);
      return grey;
    default:
      break;
  }
  throw base::Error("features: an image of " + std::to_string(image.channels()) + " channels of type " +
                    cv::depthToString(image.depth()) + "; give 8-bit images with 1, 3 or 4 channels");
}

void checkMask(const cv::Mat& image, const cv::Mat& mask) {
  if (mask.empty()) return;
  if (mask.type() != CV_8UC1) throw base::Error("features: the image mask must be 8 bit with one channel");
  if (mask.size() != image.size())
    throw base::Error("features: the image mask is " + sizeText(mask) + " but the image is " +
                      sizeText(image) + "; give a mask of the size of the image");
}

bool hasTexture(const cv::Mat& grey) {
  if (grey.cols < kSmallestSide || grey.rows < kSmallestSide) return false;
  double low = 0, high = 0;
  cv::minMaxLoc(grey, &low, &high);
  return high > low;
}

}  // namespace

types::Features BaseExtractor::extract(const cv::Mat& image, const cv::Mat& mask) const {
  types::Features none;
  none.descriptors = types::Descriptors(kind_, dim_);
  const cv::Mat grey = toGrey(image);
  checkMask(image, mask);
  if (!hasTexture(grey)) return none;

  Detection detection;
  std::vector<int> usable;
  double factor = 1.0;
  for (int attempt = 0; attempt <= params_.retries; ++attempt, factor *= kThresholdStep) {
    detection = detect(grey, factor);
    usable = insideMask(detection.keypoints, mask, params_.mask_margin);
    if (static_cast<int>(usable.size()) >= std::min(params_.min_features, params_.max_features)) break;
  }
  const auto kept = strongest(detection.keypoints, std::move(usable), grey.size(), params_.max_features,
                              params_.grid_cells);
  if (kept.empty()) return none;
  const types::Features found = describeAll(grey, detection, kept);
  return found.subset(strongestFirst(found.keypoints));
}

}  // namespace engram::features

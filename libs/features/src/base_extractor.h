// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/features/extractor.h"
#include "integral_image.h"

#include <opencv2/core.hpp>

#include <span>
#include <vector>

namespace engram::features {

/// What all extractors share: checks, grey image, retries with a lower threshold, mask, selection.
class BaseExtractor : public Extractor {
 public:
  BaseExtractor(const ExtractorParams& params, types::DescriptorKind kind, int dim)
      : params_(params), kind_(kind), dim_(dim) {}

  types::Features extract(const cv::Mat& image, const cv::Mat& mask) const final;
  types::DescriptorKind kind() const final { return kind_; }
  int dim() const final { return dim_; }
  std::string name() const final { return params_.extractor; }

 protected:
  /// Detected points, with whatever the strategy needs to describe them; parallel arrays where not empty.
  struct Detection {
    std::vector<types::Keypoint> keypoints;
    std::vector<cv::KeyPoint> raw;
    cv::Mat descriptors;
    std::shared_ptr<const IntegralImage> integral;
  };

  /// @param thresholdFactor scales the strategy's threshold; 1 at first.
  virtual Detection detect(const cv::Mat& grey, double thresholdFactor) const = 0;
  /// The features with these indices of `detection`, in any order.
  virtual types::Features describeAll(const cv::Mat& grey, const Detection& detection,
                                      std::span<const int> indices) const = 0;

  const ExtractorParams params_;

 private:
  const types::DescriptorKind kind_;
  const int dim_;
};

}  // namespace engram::features

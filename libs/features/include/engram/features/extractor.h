// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/types/features.h"

#include <opencv2/core/mat.hpp>

#include <memory>
#include <string>

namespace engram::features {

/// How features are extracted: section `[extractor]`.
struct ExtractorParams {
  std::string extractor = "surf";
  int max_features = 600;
  int min_features = 200;
  int retries = 3;
  int grid_cells = 0;
  double mask_margin = 0.6;
  bool upright = false;

  double surf_threshold = 5e-5;
  int surf_octaves = 4;
  int surf_step = 1;
  double akaze_threshold = 0.001;
  double sift_contrast = 0.04;
  bool sift_root = true;
  int orb_threshold = 20;
  int orb_levels = 8;

  void describe(base::Params& p);
};

/// Finds and describes interest points. Extraction is const and may run in several threads at once; the same
/// image gives the same bytes.
class Extractor {
 public:
  virtual ~Extractor() = default;

  /// Features of an image, strongest first. An image without texture gives none.
  /// @param image 8 bit, 1, 3 (BGR) or 4 (BGRA) channels.
  /// @param mask  8 bit, size of the image, 0 where features are not wanted; may be empty. Features whose
  /// described
  ///              region reaches over its border are dropped too (`mask_margin`). The image border does not
  ///              count.
  /// @throws base::Error when image or mask have another type or size.
  virtual types::Features extract(const cv::Mat& image, const cv::Mat& mask) const = 0;

  virtual types::DescriptorKind kind() const = 0;  ///< kFloat or kBinary
  virtual int dim() const = 0;                     ///< components, or bits
  virtual std::string name() const = 0;            ///< as in `ExtractorParams::extractor`
};

/// @throws base::ConfigError when a parameter is out of range.
std::unique_ptr<Extractor> makeExtractor(const ExtractorParams& params);

}  // namespace engram::features

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/cameras/image_plane.h"

#include <opencv2/core/types.hpp>

#include <string>

namespace engram::cameras {

/// The section [camera] of a calibration file. Which keys exist depends on the model.
struct CalibrationText {
  std::string model = "pinhole";
  int width = 0, height = 0;
  double xi = 0;
  ImagePlaneParams plane{};
  double fov_deg = 0;    // pinhole only, instead of fx, fy, cx, cy; 0: not given
  bool reading = false;  // fov_deg is understood but never written

  void describe(base::Params& p);
  /// Only the fields of the model.
  std::string dump();
};

/// Throws base::Error for an image without pixels.
void checkSize(cv::Size size);

cv::Size scaledSize(cv::Size size, double factorX, double factorY);

}  // namespace engram::cameras

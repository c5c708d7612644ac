// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera_rig.h"

#include <opencv2/core/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// The inner corners of a chessboard in one image.
struct BoardView {
  std::string name;
  std::vector<cv::Point2f> corners;  ///< [px], row after row
};

/// Chessboard corners to a fraction of a pixel, strongly distorted images included; none when not all are
/// seen.
/// @param inner inner corners along the rows and columns.
std::optional<std::vector<cv::Point2f>> findBoard(const cv::Mat& image, cv::Size inner);

struct CalibrationOptions {
  bool unified = true;    ///< unified sphere model (Mei), else pinhole; both with plumb_bob distortion
  cv::Size board{9, 6};   ///< inner corners
  double square = 0.03;   ///< side of a square [m]; only its ratio to the other distances matters
  bool mirrored = false;  ///< the image is seen through one mirror: left and right are exchanged
};

struct CalibrationResult {
  std::shared_ptr<const cameras::Camera> camera;
  double rms = 0.0;  ///< of the corners of the views used [px]
  struct View {
    std::string name;
    double rms = 0.0;  ///< [px]; 0 when the view was not used
    bool used = false;
  };
  std::vector<View> views;
};

/// Calibrates from at least 3 views of the size `size`. Views that fit much worse than the others are left
/// out. Throws base::Error when there are too few views or no solution.
CalibrationResult calibrate(const std::vector<BoardView>& views, cv::Size size,
                            const CalibrationOptions& options);

}  // namespace engram::apps

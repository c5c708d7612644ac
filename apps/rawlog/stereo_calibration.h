// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration.h"
#include "engram/cameras/stereo_rig.h"

#include <string>
#include <vector>

namespace engram::apps {

/// One board seen by both eyes, corner i of one being corner i of the other.
struct BoardPair {
  std::string name;
  std::vector<cv::Point2f> left, right;  ///< [px]
};

/// Chessboard corners of both images; none when one of them does not show all. The detector may count a board
/// from either end: the right corners are brought into the order of the left ones.
std::optional<BoardPair> findBoards(const cv::Mat& left, const cv::Mat& right, cv::Size inner,
                                    const std::string& name);

struct StereoCalibrationResult {
  cameras::StereoRig rig;  ///< with the default mount
  double rms = 0.0;        ///< of the corners of the views used, both eyes [px]
  double rowError = 0.0;   ///< root mean square distance of the rows of rectified corners [px]
  double squareError = 0;  ///< the sides of the squares, measured in stereo: root mean square error [m]
  std::vector<CalibrationResult::View> views;
};

/// Calibrates both eyes and the pose between them (cv::stereoCalibrate) from at least 5 views. Views that fit
/// much worse than the others are left out. Throws base::Error when there are too few views or no solution.
/// @param options its model must be pinhole.
StereoCalibrationResult calibrateStereo(const std::vector<BoardPair>& views, cv::Size size,
                                        const CalibrationOptions& options);

}  // namespace engram::apps

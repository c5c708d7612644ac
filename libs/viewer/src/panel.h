// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/frame_report.h"

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace engram::viewer {

/// What the robot knows of its whereabouts, in one word.
enum class RobotState { kTracking, kNewPlace, kLost, kBlind };

/// The state after this image; an image that was skipped tells nothing new.
RobotState stateAfter(const types::FrameReport& report, RobotState before);
const char* toString(RobotState state);

/// A feature of the image at hand.
struct Mark {
  enum class Kind { kUnknown, kShortTerm, kLongTerm };
  cv::Point2f at;  ///< [px] of the image
  float size = 4.0f;
  Kind kind = Kind::kUnknown;
};

/// What is shown beside the map.
struct PanelContent {
  cv::Mat image;            ///< the image at hand
  std::vector<Mark> marks;  ///< its features
  cv::Mat matched;          ///< the reference view of the place; empty when there is none
  RobotState state = RobotState::kBlind;
  types::FrameReport report;
  std::size_t places = 0;  ///< of the map
};

/// Image with features (long-term green, short-term orange, unknown grey), the matched view beside it, the
/// belief as bars over the places, and the state in words.
/// @return BGR, `size`
cv::Mat drawPanel(const PanelContent& content, cv::Size size);

}  // namespace engram::viewer

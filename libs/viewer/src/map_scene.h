// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "snapshot.h"

#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>

namespace engram::viewer {

/// The map on the left, the panel on the right.
class MapScene {
 public:
  /// @param share of the width that the map takes
  explicit MapScene(double share);

  mrpt::opengl::COpenGLScene::Ptr scene() const { return scene_; }
  void show(const MapSketch& map);
  void showPanel(const cv::Mat& panel);

  Eigen::Vector3f centre() const { return 0.5f * (low_ + high_); }
  float extent() const { return std::max(4.0f, (high_ - low_).norm()); }  ///< of the map [m]

 private:
  mrpt::opengl::COpenGLScene::Ptr scene_;
  mrpt::opengl::CPointCloudColoured::Ptr places_;
  mrpt::opengl::CSetOfLines::Ptr travelled_, closures_, weak_, path_;
  mrpt::opengl::CSetOfObjects::Ptr robot_;
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero(), high_ = Eigen::Vector3f::Zero();
};

}  // namespace engram::viewer

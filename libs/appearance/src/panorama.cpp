// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/appearance/panorama.h"

#include <opencv2/imgproc.hpp>

#include <cmath>
#include <numbers>

namespace engram::appearance {
namespace {

constexpr double kElevation = std::numbers::pi / 6;  // of the upper and lower end of a strip [rad]

}  // namespace

std::optional<Panorama> Panorama::of(const cameras::CameraRig& rig) {
  const std::string model = rig.camera->model();
  if (model != "unified_sphere" && model != "equirectangular") return std::nullopt;
  return Panorama(rig);
}

cv::Mat Panorama::strip(const cv::Mat& picture, cv::Size size) const {
  const cv::Size full = rig_.camera->imageSize();
  const double scaleX = static_cast<double>(picture.cols) / full.width;
  const double scaleY = static_cast<double>(picture.rows) / full.height;
  const Eigen::Matrix3d R_cam_robot = rig_.T_robot_cam.linear().transpose();
  cv::Mat x(size, CV_32F, -1.0F), y(size, CV_32F, -1.0F);
  for (int row = 0; row < size.height; ++row) {
    const double elevation = kElevation * (1 - 2 * (row + 0.5) / size.height);
    for (int column = 0; column < size.width; ++column) {
      const double heading = 2 * std::numbers::pi * (column + 0.5) / size.width;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(heading),
                                std::cos(elevation) * std::sin(heading), std::sin(elevation));
      const auto pixel = rig_.camera->project(R_cam_robot * ray);
      if (!pixel) continue;
      x.at<float>(row, column) = static_cast<float>((pixel->x() + 0.5) * scaleX - 0.5);
      y.at<float>(row, column) = static_cast<float>((pixel->y() + 0.5) * scaleY - 0.5);
    }
  }
  cv::Mat out;
  cv::remap(picture, out, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return out;
}

}  // namespace engram::appearance

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/cameras/camera.h"

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include <cmath>

namespace engram::apps::testing_board {

inline const cv::Size kBoard(9, 6);
inline constexpr double kSquare = 0.03;

/// A board that faces the camera from direction (azimuth, angle from the optical axis), tilted a little.
inline Eigen::Isometry3d boardPose(double azimuth, double polar, double distance, base::Rng& rng) {
  const Eigen::Vector3d direction(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                  std::cos(polar));
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction).toRotationMatrix() *
               Eigen::AngleAxisd(rng.uniform(-0.4, 0.4), Eigen::Vector3d::UnitX()).toRotationMatrix() *
               Eigen::AngleAxisd(rng.uniform(-0.4, 0.4), Eigen::Vector3d::UnitY()).toRotationMatrix() *
               Eigen::AngleAxisd(rng.uniform(-0.5, 0.5), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = distance * direction - T.linear() * Eigen::Vector3d(4 * kSquare, 2.5 * kSquare, 0);
  return T;
}

/// The picture that `camera` takes of a board: white squares, black squares and a white margin on grey.
inline cv::Mat render(const cameras::Camera& camera, const Eigen::Isometry3d& T) {
  constexpr int kFine = 3;
  cv::Mat fine(camera.imageSize() * kFine, CV_8U, cv::Scalar(120));
  const Eigen::Isometry3d inverse = T.inverse();
  for (int y = 0; y < fine.rows; ++y)
    for (int x = 0; x < fine.cols; ++x) {
      const auto ray = camera.unproject(Eigen::Vector2d((x + 0.5) / kFine - 0.5, (y + 0.5) / kFine - 0.5));
      if (!ray) continue;
      const Eigen::Vector3d d = inverse.linear() * *ray, o = inverse.translation();
      const double s = -o.z() / d.z();
      if (!(s > 0)) continue;
      const double u = (o.x() + s * d.x()) / kSquare + 1, v = (o.y() + s * d.y()) / kSquare + 1;
      const bool onBoard = u > 0 && v > 0 && u < kBoard.width + 1 && v < kBoard.height + 1;
      const bool onMargin = u > -0.6 && v > -0.6 && u < kBoard.width + 1.6 && v < kBoard.height + 1.6;
      const bool dark = onBoard && (static_cast<int>(u) + static_cast<int>(v)) % 2 == 0;
      if (onMargin) fine.at<std::uint8_t>(y, x) = dark ? 30 : 230;
    }
  cv::Mat image;
  cv::resize(fine, image, camera.imageSize(), 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(image, image, {}, 0.7);
  return image;
}

}  // namespace engram::apps::testing_board

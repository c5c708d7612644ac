// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/bags/bag.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <optional>
#include <span>

namespace engram::bags {

/// std_msgs/Header.
struct RosHeader {
  double stamp = 0.0;  ///< [s] since the Unix epoch; 0 where the sender set none
  std::string frame;   ///< without the slash that ROS 1 has before it
};

/// sensor_msgs/CameraInfo. Frames and matrices as its definition has them.
struct RosCameraInfo {
  RosHeader header;
  std::uint32_t width = 0, height = 0;  ///< [px]
  std::string model;                    ///< of the distortion
  std::vector<double> D, K, R, P;       ///< coefficients; 3x3, 3x3, 3x4 by rows
};

/// A pose of `child` in `header.frame`: nav_msgs/Odometry or geometry_msgs/TransformStamped.
struct RosPose {
  RosHeader header;
  std::string child;
  Eigen::Isometry3d T_frame_child = Eigen::Isometry3d::Identity();
};

/// What became of an image.
struct RosImage {
  RosHeader header;
  cv::Mat image;        ///< 8 bit, 1 or 3 (BGR) channels; empty when it cannot be used
  std::string failure;  ///< then, why
};

bool isImageType(const std::string& type);
bool isTransformType(const std::string& type);

/// Each throws base::Error for a message that is too short for its type, or a pose that is none.
RosHeader readHeader(const BagMessage& message, const BagTopic& topic);
RosCameraInfo readCameraInfo(const BagMessage& message, const BagTopic& topic);
RosPose readOdometry(const BagMessage& message, const BagTopic& topic);
std::vector<RosPose> readTransforms(const BagMessage& message, const BagTopic& topic);
/// sensor_msgs/Image and CompressedImage; Bayer mosaics and YUV become colour.
RosImage readImage(const BagMessage& message, const BagTopic& topic);

}  // namespace engram::bags

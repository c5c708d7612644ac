// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros_messages.h"

#include "engram/base/image_header.h"
#include "engram/base/text.h"
#include "engram/sources/image_bytes.h"
#include "ros_wire.h"

#include <opencv2/imgproc.hpp>

#include <cmath>

namespace engram::bags {
namespace {

std::string frameName(const std::string& name) { return name.starts_with('/') ? name.substr(1) : name; }

RosHeader headerOf(RosWire& wire) {
  if (!wire.cdr()) wire.value<std::uint32_t>();  // sequence number
  RosHeader header;
  const double seconds = wire.value<std::uint32_t>();
  header.stamp = seconds + 1e-9 * wire.value<std::uint32_t>();
  header.frame = frameName(wire.text());
  return header;
}

/// Position, then the quaternion with w last.
Eigen::Isometry3d poseOf(RosWire& wire) {
  const auto t = wire.doubles(3), q = wire.doubles(4);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  const Eigen::Vector3d position(t[0], t[1], t[2]);
  if (!(std::abs(rotation.norm() - 1.0) < 0.01) || !position.allFinite())
    throw base::Error("a pose without position or orientation");
  T.linear() = rotation.normalized().toRotationMatrix();
  T.translation() = position;
  return T;
}

/// How the pixels of an encoding lie in a row, and what makes them grey or BGR.
struct PixelLayout {
  const char* encoding;
  int channels;
  int conversion;  // of OpenCV; -1: none
};

// OpenCV names a mosaic by the second row and column (BayerBG is RGGB of ROS).
constexpr PixelLayout kLayouts[] = {{"mono8", 1, -1},
                                    {"8UC1", 1, -1},
                                    {"bgr8", 3, -1},
                                    {"8UC3", 3, -1},
                                    {"rgb8", 3, cv::COLOR_RGB2BGR},
                                    {"bgra8", 4, cv::COLOR_BGRA2BGR},
                                    {"8UC4", 4, cv::COLOR_BGRA2BGR},
                                    {"rgba8", 4, cv::COLOR_RGBA2BGR},
                                    {"bayer_rggb8", 1, cv::COLOR_BayerBG2BGR},
                                    {"bayer_bggr8", 1, cv::COLOR_BayerRG2BGR},
                                    {"bayer_gbrg8", 1, cv::COLOR_BayerGR2BGR},
                                    {"bayer_grbg8", 1, cv::COLOR_BayerGB2BGR},
                                    {"yuv422", 2, cv::COLOR_YUV2BGR_UYVY},
                                    {"uyvy", 2, cv::COLOR_YUV2BGR_UYVY},
                                    {"yuv422_yuy2", 2, cv::COLOR_YUV2BGR_YUY2},
                                    {"yuyv", 2, cv::COLOR_YUV2BGR_YUY2}};

void readPixels(RosWire& wire, RosImage& out) {
  const auto height = wire.value<std::uint32_t>(), width = wire.value<std::uint32_t>();
  const std::string encoding = wire.text();
  wire.value<std::uint8_t>();  // byte order, of no matter to 8 bits
  const auto step = wire.value<std::uint32_t>();
  const auto pixels = wire.bytes();
  const auto* layout = std::find_if(std::begin(kLayouts), std::end(kLayouts),
                                    [&](const PixelLayout& each) { return encoding == each.encoding; });
  if (layout == std::end(kLayouts)) {
    out.failure = "images of encoding " + base::quoted(encoding) + " cannot be used";
  } else if (!base::plausibleSize(width, height)) {
    out.failure = base::sizeRefusal(width, height);
  } else if (step < width * static_cast<std::uint32_t>(layout->channels) ||
             pixels.size() < std::uint64_t{step} * height) {
    out.failure = "the pixels are incomplete";
  } else {
    const cv::Mat view(static_cast<int>(height), static_cast<int>(width), CV_8UC(layout->channels),
                       const_cast<std::uint8_t*>(pixels.data()), step);
    try {
      layout->conversion < 0 ? view.copyTo(out.image) : cv::cvtColor(view, out.image, layout->conversion);
    } catch (const cv::Exception&) {  // a mosaic of one row
      out.image.release();
      out.failure = "too small for its encoding " + base::quoted(encoding);
    }
  }
}

RosWire wireOf(const BagMessage& message, const BagTopic& topic) { return {message.data, topic.cdr}; }

}  // namespace

bool isImageType(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage";
}

bool isTransformType(const std::string& type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";
}

RosHeader readHeader(const BagMessage& message, const BagTopic& topic) {
  RosWire wire = wireOf(message, topic);
  return headerOf(wire);
}

RosCameraInfo readCameraInfo(const BagMessage& message, const BagTopic& topic) {
  RosWire wire = wireOf(message, topic);
  RosCameraInfo info;
  info.header = headerOf(wire);
  info.height = wire.value<std::uint32_t>();
  info.width = wire.value<std::uint32_t>();
  info.model = wire.text();
  info.D = wire.doubles(wire.value<std::uint32_t>());
  info.K = wire.doubles(9);
  info.R = wire.doubles(9);
  info.P = wire.doubles(12);
  return info;
}

RosPose readOdometry(const BagMessage& message, const BagTopic& topic) {
  RosWire wire = wireOf(message, topic);
  RosPose pose;
  pose.header = headerOf(wire);
  pose.child = frameName(wire.text());
  pose.T_frame_child = poseOf(wire);
  return pose;
}

std::vector<RosPose> readTransforms(const BagMessage& message, const BagTopic& topic) {
  RosWire wire = wireOf(message, topic);
  std::vector<RosPose> poses;
  for (auto left = wire.value<std::uint32_t>(); left > 0; --left) {
    RosPose pose;
    pose.header = headerOf(wire);
    pose.child = frameName(wire.text());
    pose.T_frame_child = poseOf(wire);
    poses.push_back(std::move(pose));
  }
  return poses;
}

RosImage readImage(const BagMessage& message, const BagTopic& topic) {
  RosWire wire = wireOf(message, topic);
  RosImage out;
  out.header = headerOf(wire);
  if (topic.type == "sensor_msgs/Image") {
    readPixels(wire, out);
  } else {
    wire.text();  // the format, which the bytes tell better
    out.image = sources::decodeImageBytes(wire.bytes(), out.failure);
  }
  return out;
}

}  // namespace engram::bags

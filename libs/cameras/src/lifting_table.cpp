// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/cameras/lifting_table.h"

#include "engram/base/error.h"

#include <opencv2/imgproc.hpp>

#include <cmath>

namespace engram::cameras {

LiftingTable::LiftingTable(const CameraRig& rig)
    : camera_(rig.camera),
      mask_(rig.mask.clone()),
      width_(rig.camera->imageSize().width),
      height_(rig.camera->imageSize().height),
      rays_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), Eigen::Vector3f::Zero()) {
  if (mask_.size() != rig.camera->imageSize() || mask_.type() != CV_8U)
    throw base::Error("camera: the mask must be 8-bit grey and of the size of the image");
  auto ray = rays_.begin();
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x, ++ray) {
      if (const auto exact = camera_->unproject({x, y}))
        *ray = exact->cast<float>();
      else
        mask_.at<std::uint8_t>(y, x) = 0;
    }
}

std::optional<Eigen::Vector3f> LiftingTable::bearing(float x, float y) const {
  if (x >= 0 && y >= 0 && x < static_cast<float>(width_ - 1) && y < static_cast<float>(height_ - 1)) {
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const auto* top = &rays_[static_cast<std::size_t>(y0) * static_cast<std::size_t>(width_) +
                             static_cast<std::size_t>(x0)];
    const auto* bottom = top + width_;
    if (!top[0].isZero(0) && !top[1].isZero(0) && !bottom[0].isZero(0) && !bottom[1].isZero(0)) {
      const Eigen::Vector3f mean =
          (1 - fy) * ((1 - fx) * top[0] + fx * top[1]) + fy * ((1 - fx) * bottom[0] + fx * bottom[1]);
      return mean.normalized();
    }
  }
  const auto exact = camera_->unproject({x, y});
  if (!exact) return std::nullopt;
  return exact->cast<float>();
}

std::vector<Eigen::Vector3f> LiftingTable::bearings(std::span<const types::Keypoint> keypoints) const {
  std::vector<Eigen::Vector3f> out;
  out.reserve(keypoints.size());
  for (const auto& k : keypoints) out.push_back(bearing(k.x, k.y).value_or(Eigen::Vector3f::Zero()));
  return out;
}

cv::Mat erodedMask(const cv::Mat& mask, int radius) {
  if (radius <= 0) return mask.clone();
  cv::Mat out;
  cv::erode(mask, out, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}));
  return out;
}

}  // namespace engram::cameras

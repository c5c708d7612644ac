// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reprojector.h"

#include "engram/base/error.h"
#include "engram/types/size_text.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace engram::apps {
namespace {

constexpr int kBorder = 2;  // columns repeated beyond the seam of a panorama, for interpolation across it
constexpr int kMaxFactor = 6;
constexpr double kShare = 0.9;  // of the pixels that must be sampled finely enough

Eigen::Matrix3d turn(double heading) {
  return Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

Reprojector::Reprojector(cameras::CameraRig from, cameras::CameraRig to)
    : from_(std::move(from)), to_(std::move(to)), wraps_(from_.camera->model() == "equirectangular") {
  factor_ = chooseFactor();
  fine_ = to_.camera->imageSize() * factor_;
  castRays();
}

std::optional<Eigen::Vector3d> Reprojector::rayOf(double x, double y) const {
  const auto ray = to_.camera->unproject({x, y});
  return ray ? std::optional<Eigen::Vector3d>(to_.T_robot_cam.linear() * *ray) : std::nullopt;
}

/// How many source pixels lie between neighbouring wanted pixels, for nearly all of them.
int Reprojector::chooseFactor() const {
  const Eigen::Matrix3d R_from_robot = from_.T_robot_cam.linear().transpose();
  const cv::Size size = to_.camera->imageSize();
  std::vector<double> steps;
  for (int y = 4; y < size.height - 1; y += 8)
    for (int x = 4; x < size.width - 1; x += 8) {
      const auto here = rayOf(x, y), right = rayOf(x + 1, y), below = rayOf(x, y + 1);
      if (to_.mask.at<std::uint8_t>(y, x) == 0 || !here || !right || !below) continue;
      const auto p = from_.camera->project(R_from_robot * *here);
      const auto q = from_.camera->project(R_from_robot * *right);
      const auto r = from_.camera->project(R_from_robot * *below);
      if (p && q && r) steps.push_back(std::max((*q - *p).norm(), (*r - *p).norm()));
    }
  if (steps.empty())
    throw base::Error("the camera of the images and that of --reproject see no common direction");
  const auto at = steps.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(steps.size() - 1));
  std::nth_element(steps.begin(), at, steps.end());
  return std::clamp(static_cast<int>(std::ceil(*at)), 1, kMaxFactor);
}

void Reprojector::castRays() {
  rays_.assign(static_cast<std::size_t>(fine_.area()), Eigen::Vector3f::Zero());
  for (int y = 0; y < fine_.height; ++y)
    for (int x = 0; x < fine_.width; ++x) {
      // The centre of the top left pixel is (0, 0), in the fine image too.
      const auto ray = rayOf((x + 0.5) / factor_ - 0.5, (y + 0.5) / factor_ - 0.5);
      if (ray) rays_[static_cast<std::size_t>(y * fine_.width + x)] = ray->cast<float>();
    }
}

cv::Mat Reprojector::operator()(const cv::Mat& image, double heading) const {
  if (image.size() != from_.camera->imageSize())
    throw base::Error("an image of " + types::sizeText(image.size()) + " pixels, but its camera has " +
                      types::sizeText(from_.camera->imageSize()));
  const Eigen::Matrix3d R = from_.T_robot_cam.linear().transpose() * turn(heading);
  const int border = wraps_ ? kBorder : 0;
  cv::Mat map(fine_, CV_32FC2);
  for (int y = 0; y < fine_.height; ++y)
    for (int x = 0; x < fine_.width; ++x) {
      const Eigen::Vector3f& ray = rays_[static_cast<std::size_t>(y * fine_.width + x)];
      std::optional<Eigen::Vector2d> pixel;
      if (!ray.isZero()) pixel = from_.camera->project(R * ray.cast<double>());
      auto& entry = map.at<cv::Vec2f>(y, x);
      entry = pixel ? cv::Vec2f(static_cast<float>(pixel->x() + border), static_cast<float>(pixel->y()))
                    : cv::Vec2f(-10.0f, -10.0f);
    }
  cv::Mat source = image;
  if (wraps_) cv::copyMakeBorder(image, source, 0, 0, border, border, cv::BORDER_WRAP);
  cv::Mat fine, out;
  cv::remap(source, fine, map, {}, cv::INTER_LINEAR, wraps_ ? cv::BORDER_REPLICATE : cv::BORDER_CONSTANT);
  cv::resize(fine, out, to_.camera->imageSize(), 0, 0, cv::INTER_AREA);
  out.setTo(cv::Scalar::all(0), to_.mask == 0);
  return out;
}

}  // namespace engram::apps

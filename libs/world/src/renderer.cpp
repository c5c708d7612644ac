// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/renderer.h"

#include "engram/base/parallel.h"

#include <algorithm>
#include <cmath>

namespace engram::world {
namespace {

constexpr std::size_t kNormals = 1 << 16;
constexpr int kMeterRays = 400;

// Standard normal numbers, drawn once: a picture needs half a million.
const std::vector<float>& normals() {
  static const std::vector<float> table = [] {
    std::vector<float> t(kNormals);
    base::Rng rng(77);
    for (auto& v : t) v = static_cast<float>(rng.normal());
    return t;
  }();
  return table;
}

std::uint32_t hashOf(std::uint32_t x) {
  x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

}  // namespace

void SensorParams::describe(base::Params& p) {
  p.add("samples", samples, "rays a pixel, spread over the pixel and the exposure", {1, 64});
  p.add("vignetting", vignetting, "loss of light at the corners", {0, 1});
  p.add("full_well", full_well, "electrons at saturation (shot noise)", {10, 1e6});
  p.add("read_noise", read_noise, "noise of reading a pixel [electrons]", {0, 1000});
  p.add("max_exposure", max_exposure, "longest exposure; darker scenes are amplified [s]", {1e-5, 1});
  p.add("bright_exposure", bright_exposure, "exposure that a scene of mean radiance 1 needs [s]", {1e-5, 1});
  p.add("exposure_lag", exposure_lag, "time constant of the auto-exposure [s]", {0, 60});
  p.add("target", target, "mean of the picture that the auto-exposure wants, linear", {0.01, 1});
  p.add("noise", noise, "shot and read noise");
}

RayTable::RayTable(const cameras::CameraRig& rig, int samples) : size_(rig.camera->imageSize()) {
  const double halfDiagonal = std::hypot(size_.width, size_.height) / 2;
  rays_.resize(static_cast<std::size_t>(samples)), rowStart_.resize(rays_.size());
  for (int k = 0; k < samples; ++k) {
    // Samples on a golden-ratio lattice in the pixel; a single one is in its centre.
    const double jx = samples == 1 ? 0 : std::fmod(0.5 + k * 0.7548776662, 1.0) - 0.5;
    const double jy = samples == 1 ? 0 : (k + 0.5) / samples - 0.5;
    auto& list = rays_[static_cast<std::size_t>(k)];
    auto& start = rowStart_[static_cast<std::size_t>(k)];
    for (int y = 0; y < size_.height; ++y) {
      start.push_back(static_cast<std::int32_t>(list.size()));
      for (int x = 0; x < size_.width; ++x) {
        if (rig.mask.at<std::uint8_t>(y, x) == 0) continue;
        const auto ray = rig.camera->unproject({x + jx, y + jy});
        if (!ray) continue;
        const auto right = rig.camera->unproject({x + jx + 0.5, y + jy}),
                   below = rig.camera->unproject({x + jx, y + jy + 0.5});
        double angle = 0;
        for (const auto& other : {right, below})
          if (other) angle = std::max(angle, 2 * (*other - *ray).norm());
        const double r = std::hypot(x - size_.width / 2.0, y - size_.height / 2.0) / halfDiagonal;
        list.push_back({ray->cast<float>().array(), static_cast<float>(angle), static_cast<float>(r * r),
                        y * size_.width + x});
      }
    }
    start.push_back(static_cast<std::int32_t>(list.size()));
  }
}

Renderer::Renderer(const cameras::CameraRig& rig, const SensorParams& params)
    : params_(params), rays_(rig, params.samples) {
  base::validate(params);
}

void Renderer::renderRow(const Scene& scene, const Shot& shot, const std::vector<Eigen::Isometry3f>& poses,
                         int row, cv::Mat& image) const {
  const int width = rays_.size().width, samples = rays_.samples();
  std::vector<Colour> light(static_cast<std::size_t>(width), Colour::Zero());
  std::vector<float> loss(light.size(), -1.0f);
  for (int k = 0; k < samples; ++k) {
    const auto& start = rays_.rowStart(k);
    for (int i = start[static_cast<std::size_t>(row)]; i < start[static_cast<std::size_t>(row) + 1]; ++i) {
      const RayTable::Ray& ray = rays_.rays(k)[static_cast<std::size_t>(i)];
      const float random = static_cast<float>(hashOf(static_cast<std::uint32_t>(ray.pixel)) >> 8) * 0x1p-24f;
      const float phase =
          (static_cast<float>(k) + random) / static_cast<float>(samples);  // within the exposure
      const auto& pose = poses[std::min(poses.size() - 1,
                                        static_cast<std::size_t>(phase * static_cast<float>(poses.size())))];
      const Eigen::Array3f direction = (pose.linear() * ray.direction.matrix()).array();
      const float dither =
          std::fmod(random + (static_cast<float>(k) + 0.5f) / static_cast<float>(samples), 1.0f);
      const auto x = static_cast<std::size_t>(ray.pixel - row * width);
      light[x] += scene.radiance(pose.translation().array(), direction, ray.footprint, dither, shot.people)
                      .min(20.0f);
      loss[x] = ray.brightness;
    }
  }
  const auto& table = normals();
  const base::Rng rng = base::Rng(shot.seed).fork(static_cast<std::uint64_t>(row));
  std::size_t next = base::Rng(rng).below(kNormals);
  const auto gain = static_cast<float>(shot.exposure.gain / samples),
             vignetting = static_cast<float>(params_.vignetting);
  const auto reference = static_cast<float>(params_.target / params_.bright_exposure);
  const float amplify =
      std::max(1.0f, static_cast<float>(shot.exposure.gain / (shot.exposure.seconds * reference)));
  const float shot2 = amplify / static_cast<float>(params_.full_well);
  const float read = amplify * static_cast<float>(params_.read_noise / params_.full_well);
  for (std::size_t x = 0; x < light.size(); ++x) {
    if (loss[x] < 0) continue;
    auto& pixel = image.at<cv::Vec3b>(row, static_cast<int>(x));
    const Colour value = light[x] * (gain * (1 - vignetting * loss[x]));
    for (int c = 0; c < 3; ++c) {
      float v = value[c];
      if (params_.noise) v += std::sqrt(v * shot2 + read * read) * table[next++ & (kNormals - 1)];
      pixel[c] = static_cast<std::uint8_t>(255.0f * std::sqrt(std::clamp(v, 0.0f, 1.0f)) + 0.5f);  // gamma 2
    }
  }
}

cv::Mat Renderer::render(const Scene& scene, const Shot& shot, int threads) const {
  cv::Mat image(rays_.size(), CV_8UC3, cv::Scalar::all(0));
  std::vector<Eigen::Isometry3f> poses;
  for (const auto& T : shot.T_world_cam) poses.push_back(T.cast<float>());
  base::parallelFor(static_cast<std::size_t>(image.rows), threads,
                    [&](std::size_t row) { renderRow(scene, shot, poses, static_cast<int>(row), image); });
  return image;
}

double Renderer::meter(const Scene& scene, const Eigen::Isometry3d& T_world_cam,
                       std::span<const Pillar> people) const {
  const auto& rays = rays_.rays(0);
  if (rays.empty()) return 1;
  const Eigen::Isometry3f pose = T_world_cam.cast<float>();
  const std::size_t stride = std::max<std::size_t>(1, rays.size() / kMeterRays);
  double sum = 0;
  int count = 0;
  for (std::size_t i = stride / 2; i < rays.size(); i += stride, ++count) {
    const Eigen::Array3f d = (pose.linear() * rays[i].direction.matrix()).array();
    const Colour c = scene.radiance(pose.translation().array(), d, 0.1f, 0, people);
    sum += std::min(2.0f, (c[0] + c[1] + c[2]) / 3);
  }
  return sum / count;
}

Exposure Renderer::expose(double radiance) const {
  const double safe = std::max(radiance, 1e-4);
  Exposure e;
  e.seconds = std::min(params_.max_exposure, params_.bright_exposure / safe);
  e.gain = params_.target / safe;
  return e;
}

}  // namespace engram::world

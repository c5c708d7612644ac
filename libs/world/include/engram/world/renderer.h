// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/cameras/camera_rig.h"
#include "engram/world/scene.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace engram::world {

/// The simulated sensor. Section [sensor].
struct SensorParams {
  int samples = 2;                 ///< rays a pixel, spread over the pixel and the exposure
  double vignetting = 0.35;        ///< loss of light at the corners, 0 none
  double full_well = 9000;         ///< electrons at saturation: shot noise
  double read_noise = 6;           ///< electrons
  double max_exposure = 0.025;     ///< [s]; darker scenes are amplified instead
  double bright_exposure = 0.006;  ///< [s] needed for a scene of mean radiance 1
  double exposure_lag = 1.2;       ///< [s] time constant of the auto-exposure
  double target = 0.20;  ///< mean of the picture that the auto-exposure wants, linear, 1 = saturation
  bool noise = true;
  void describe(base::Params& p);
};

/// How long and how strongly the sensor collects light.
struct Exposure {
  double seconds = 0.01;
  double gain = 1;  ///< pixel = radiance * gain, 1 = saturation
};

/// The rays of a camera, computed once.
class RayTable {
 public:
  RayTable(const cameras::CameraRig& rig, int samples);
  struct Ray {
    Eigen::Array3f direction;  ///< unit, in the frame of the camera
    float footprint;           ///< angle of a pixel [rad]
    float brightness;          ///< share of light left by vignetting, before SensorParams::vignetting
    std::int32_t pixel;        ///< row * width + column
  };
  /// Rays of sample k in order of pixels; `rowStart(k)` indexes them by image row.
  const std::vector<Ray>& rays(int sample) const { return rays_[static_cast<std::size_t>(sample)]; }
  const std::vector<std::int32_t>& rowStart(int sample) const {
    return rowStart_[static_cast<std::size_t>(sample)];
  }
  int samples() const { return static_cast<int>(rays_.size()); }
  cv::Size size() const { return size_; }

 private:
  cv::Size size_;
  std::vector<std::vector<Ray>> rays_;
  std::vector<std::vector<std::int32_t>> rowStart_;
};

/// One picture to take. Poses are T_world_cam; with more than one the exposure is spread over them in order.
struct Shot {
  std::vector<Eigen::Isometry3d> T_world_cam;
  std::vector<Pillar> people;
  Exposure exposure;
  std::uint64_t seed = 0;  ///< of the noise
};

/// Takes pictures. The bytes depend on the shot alone, not on the number of threads.
class Renderer {
 public:
  Renderer(const cameras::CameraRig& rig, const SensorParams& params);

  /// 8 bit BGR; black where the mask hides the world.
  cv::Mat render(const Scene& scene, const Shot& shot, int threads) const;

  /// Mean radiance that the light meter sees: a few hundred rays of the same view, bright lamps cut off.
  double meter(const Scene& scene, const Eigen::Isometry3d& T_world_cam,
               std::span<const Pillar> people) const;

  /// Exposure for a metered radiance.
  Exposure expose(double radiance) const;

  const RayTable& rays() const { return rays_; }

 private:
  void renderRow(const Scene& scene, const Shot& shot, const std::vector<Eigen::Isometry3f>& poses, int row,
                 cv::Mat& image) const;

  SensorParams params_;
  RayTable rays_;
};

}  // namespace engram::world

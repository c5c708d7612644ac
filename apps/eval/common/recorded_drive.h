// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/perception.h"
#include "engram/types/features.h"
#include "engram/world/world.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace engram::apps {

/// One image of a simulated drive as the experiments see it: features and truth.
struct Sample {
  double stamp = 0.0;  ///< [s]
  double arc = 0.0;    ///< true position along the nominal tour [m]
  Eigen::Isometry3d T_world_robot = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_odom_robot = Eigen::Isometry3d::Identity();
  types::Features features;
  types::Features noisy;  ///< of the same image with noise; empty unless asked for
};

struct RecordedDrive {
  int session = 0;        ///< day of the world, from 1
  std::string weather;    ///< what the building looked like, in words
  double tourLength = 0;  ///< [m]
  std::vector<Sample> samples;
};

/// Which images of a drive are taken, by their position along the tour [m].
struct Selection {
  std::string name;  ///< tells selections apart
  std::function<std::vector<std::size_t>(const std::vector<double>& arcs)> choose;
};

/// The image nearest to each of `stations` points evenly spaced along a closed tour.
Selection nearestToStations(int stations, double tourLength);
Selection allImages();

/// Renders drives and extracts their features once; later runs read them from the folder, but only what the
/// same world, camera, extractor and selection made.
class DriveRecorder {
 public:
  /// @param noise sigma of the image noise, of intensities in [0, 1] (F-E15); 0 makes no noisy features.
  struct Options {
    std::string folder;
    double noise = 0.0;
    int threads = 1;
  };
  DriveRecorder(const world::World& world, world::Eyes eyes, const features::ExtractorParams& extractor,
                Options options);

  /// `progress` is called with the number of images done so far, one call at a time. Throws base::Error
  /// when Ctrl-C interrupts it; what is recorded then is the drives before.
  RecordedDrive record(int session, world::DriveKind kind, const Selection& selection,
                       const std::function<void(std::size_t)>& progress);

 private:
  RecordedDrive render(int session, world::DriveKind kind, const Selection& selection,
                       const std::function<void(std::size_t)>& progress) const;

  const world::World& world_;
  std::string madeWith_;  // all that the features depend on
  world::Eyes eyes_;
  pipeline::Perception perception_;
  Options options_;
};

/// Gaussian noise on an 8 bit image, clipped (F-E15). @param sigma of intensities in [0, 1]
void addNoise(cv::Mat& image, double sigma, std::uint64_t seed);

/// A share of the features removed, uniformly (F-E15).
types::Features without(const types::Features& features, double share, std::uint64_t seed);

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/kept_drive.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace engram::apps {

/// A part of a drive, as shares of its images, and images at which something covers both eyes.
struct ShownDrive {
  const KeptDrive* drive = nullptr;
  double from = 0, to = 1;
  bool wheels = true;                                          ///< the images come with odometry
  std::vector<std::pair<std::size_t, std::size_t>> covered{};  ///< first image and the one behind the last
};

/// What one drive did to a map of views.
struct ViewSession {
  int frames = 0;
  int viewsAdded = 0, viewsForgotten = 0;
  int links = 0;                         ///< made by place recognition
  int falseLinks = 0;                    ///< of these and of those by odometry: see ViewMapping
  int failures = 0;                      ///< runs of images that odometry could not join to the one before
  int weakMade = 0;                      ///< weak links made
  int weakLeft = 0;                      ///< in the map at the end
  int parts = 0;                         ///< of the map that normal links join, at the end
  int views = 0;                         ///< of the map at the end
  int edges = 0;                         ///< of the map at the end
  std::uint64_t bytes = 0;               ///< of the map file at the end
  double seconds = 0;                    ///< CPU
  double msPerView = 0;                  ///< CPU of the images that became views, mean
  std::map<std::string, double> stepMs;  ///< wall time by step, mean over the images that took it
  int located = 0;                       ///< views that were linked to a view of an earlier drive
};

/// A map of views that grows drive by drive, as with engram-slam, and the truth beside it. A link is false
/// when the relative pose that it measures is farther from the truth than given.
class ViewMapping {
 public:
  /// @param file of the map; replaced when it exists
  /// @param falseDistance [m] @param falseAngle [rad]
  ViewMapping(const pipeline::PipelineParams& params, std::string file, double falseDistance,
              double falseAngle);

  /// Throws base::Error when the rawlog is damaged, base::Interrupted on Ctrl-C.
  ViewSession add(const ShownDrive& shown);

  const map::TopologicalMap& map() const { return map_; }
  /// Root mean square error of all views' positions along all drives, after one alignment in space [m].
  /// Without those in other parts of the map than most of them (K-E14).
  double ate() const;
  /// Share of the positions in other parts.
  double apart() const;
  /// Way of the robot over all drives [m].
  double length() const { return length_; }

 private:
  bool isFalse(const map::TopologicalMap& map, const map::Edge& edge) const;

  pipeline::PipelineParams params_;
  std::string file_;
  double falseDistance_, falseAngle_;
  map::TopologicalMap map_;
  std::map<int, evaluation::Trajectory> truth_;  // of each session
  double length_ = 0;
};

/// Global localisation, image by image, without any memory of the images before.
struct LocatedShare {
  int images = 0, accepted = 0, right = 0;
  double msPerImage = 0;  ///< CPU
  double share() const { return images > 0 ? static_cast<double>(right) / images : 0.0; }
};

/// @param every so many metres an image is asked @param rightWithin of the place [m]
LocatedShare locateEach(const map::TopologicalMap& map, const ShownDrive& shown,
                        const pipeline::PipelineParams& params, double every, double rightWithin);

}  // namespace engram::apps

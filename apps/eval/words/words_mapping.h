// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/kept_drive.h"
#include "engram/pipeline/params.h"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// An edge that closes a loop, held against the truth.
struct ClosureRecord {
  std::uint64_t image = 0;       ///< running number in the drive
  std::uint32_t place = 0;       ///< id
  std::uint64_t placeImage = 0;  ///< the image that made the place
  double distance = 0;           ///< true distance of the robot from the place [m]
  double turn = 0;               ///< true difference of heading [rad]
  bool right = false;
  bool kept = true;                                    ///< the map holds it at the end
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the robot, true [m]
};

/// What a relaxer made of the map.
struct RelaxerResult {
  std::optional<double> ate;  ///< [m]; none when it gave up
  double cpuSeconds = 0;
};

/// The mapping experiment of A-20 on one drive.
struct MappingRun {
  std::string building;
  double length = 0, seconds = 0;  ///< of the drive [m], [s]
  int frames = 0;                  ///< images that the camera took
  int images = 0;                  ///< used, by the rule of A-06
  int places = 0;
  int recognised = 0, recognisedWrong = 0;  ///< images put to a place that was there; of these wrong ones
  std::vector<ClosureRecord> closures;
  int restored = 0;        ///< closures that were refused at their image and entered later; not in the list
  double ateOdometry = 0;  ///< root mean square over the used images, after alignment in the plane [m]
  double ateBefore = 0;    ///< the same for the map as it grew, never relaxed
  double ateMap = 0;       ///< as the pipeline left it
  std::map<std::string, RelaxerResult> after;  ///< by relaxer: the same map, relaxed at the end
  double cpuSeconds = 0;                       ///< of the pipeline, all images

  /// Positions of the used images, aligned with the truth [m].
  using Path = std::vector<Eigen::Vector2d>;
  Path truth, odometry, before, relaxed;

  /// Closures that the map holds at the end.
  int closuresThatAre(bool right) const;
  /// Closures that left the map again.
  int dropped() const;
};

/// Maps a drive in one go: the robot is not told where a round begins.
/// @param rightWithin a place that the robot is nearer to than this is right [m]
MappingRun mapDrive(const std::string& building, const KeptDrive& drive,
                    const pipeline::PipelineParams& params, double rightWithin);

/// The names of the relaxers that are compared.
const std::vector<std::string>& comparedRelaxers();

}  // namespace engram::apps

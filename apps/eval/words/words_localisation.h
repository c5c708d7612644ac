// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/kept_drive.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"
#include "engram/types/features.h"
#include "engram/types/frame.h"
#include "words/words_protocol.h"

#include <string>
#include <vector>

namespace engram::apps {

/// A way to move the belief from one image to the next: what is changed in the configuration.
struct Transition {
  std::string name;
  std::string meaning;   ///< for the report
  bool odometry = true;  ///< the frames have it; without, the filter knows nothing of the motion
  std::vector<std::string> overrides;  ///< as of --set, on the configuration in force
};
/// The ones that are compared. One more is one more line in the table.
const std::vector<Transition>& transitions();
/// The configuration with the overrides of a transition. Throws base::Error for those that it does not know.
pipeline::PipelineParams with(const Transition& transition, const pipeline::PipelineParams& params);

/// An image of the second pass.
struct PassImage {
  types::Frame frame;  ///< without the picture
  types::Features features;
  Eigen::Isometry3d T_world_robot = Eigen::Isometry3d::Identity();
};

/// The map of the first round of a drive, and the images of another pass.
struct LocalisationWorld {
  map::TopologicalMap map;
  evaluation::Trajectory learnt;  ///< true poses of the images of the first round
  std::vector<PassImage> images;  ///< those that the rule of A-06 uses
  int learned = 0;                ///< images that the map was made from
  int shown = 0;                  ///< images of both passes that the rule uses: "#IMG" of table I
  double extractionSeconds = 0;   ///< processor time of the features of one image
};
/// @param shown another drive; when it is the same one, its rounds after the first are shown
LocalisationWorld learnFirstLap(const KeptDrive& learnt, const KeptDrive& shown,
                                const pipeline::PipelineParams& params);

/// A-21 with one transition.
struct LocalisationRun {
  std::string setting, transition;
  int places = 0, shown = 0, learned = 0;
  std::vector<Attempt> attempts;
  double msPerImage = 0;  ///< processor time, features included
};

/// @param rightWithin a place that the robot is nearer to than this is right [m]
LocalisationRun localise(const LocalisationWorld& world, const Transition& transition,
                         const pipeline::PipelineParams& params, int attempts, std::uint64_t seed,
                         double rightWithin);

}  // namespace engram::apps

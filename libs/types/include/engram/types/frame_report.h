// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"
#include "engram/types/rel_pose.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace engram::types {

/// What became of one image.
enum class Outcome : std::uint8_t {
  kSkipped,     ///< not a keyframe: the robot has not moved, or the view is nearly the last one
  kUnusable,    ///< no or too few features
  kNewPlace,    ///< a place was added
  kRecognised,  ///< accepted at a known place
  kRefused,     ///< recognition refused: see `reason`; nothing was learnt from this image
};

const char* toString(Outcome outcome);

/// What an image was recognised by.
enum class AcceptedBy : std::uint8_t {
  kNothing,   ///< it was not
  kGeometry,  ///< matches that geometry verified, of this image
  kSequence,  ///< this image and those before it together; nothing is learnt from it, and it fixes no pose
};

const char* toString(AcceptedBy by);

/// One answer of recognition.
struct Hypothesis {
  base::PlaceId place;
  double similarity = 0.0;  ///< F eq (8), in [0, 1]
  double posterior = 0.0;   ///< probability after this image
  int inliers = -1;         ///< after geometric verification; -1 where none was run
};

/// What memory gained and lost.
struct MemoryChange {
  int rehearsed = 0, added = 0, pruned = 0, promoted = 0, demoted = 0;
  int longTerm = 0, shortTerm = 0;  ///< sizes afterwards

  MemoryChange& operator+=(const MemoryChange& o);
};

/// What live work knows of an image besides.
struct LiveState {
  double latency = 0.0;     ///< from the exposure to the belief [ms]
  std::size_t waiting = 0;  ///< images in the queue then
  /// Images lost so far: arrived with packets missing; never seen; dropped by the queue.
  std::size_t incomplete = 0, missed = 0, dropped = 0;
};

/// Where the robot is, by all images and odometry so far.
struct RobotPose {
  base::PlaceId place;                                            ///< that it was last certain to be at
  RelPose T_place_robot;                                          ///< with covariance
  Eigen::Isometry3d T_map_robot = Eigen::Isometry3d::Identity();  ///< [m]; the same, as the map stands now
};

/// The record of one image: every step's decision. One line of the report file.
struct FrameReport {
  std::uint64_t index = 0;  ///< Frame::index
  double stamp = 0.0;       ///< [s]
  std::string label;
  Outcome outcome = Outcome::kSkipped;
  AcceptedBy acceptedBy = AcceptedBy::kNothing;  ///< places alone
  std::string reason;                            ///< why not, in words; empty when all went well
  int features = 0;
  base::PlaceId place;      ///< the place accepted or made; invalid otherwise
  base::PlaceId bestGuess;  ///< maximum of the posterior, accepted or not; invalid on an empty map
  base::PlaceId rival;      ///< the place that explains the image as well, when it was refused for that
  double bestGuessInterpolated =
      -1.0;  ///< sub-place peak along the map's chain of places (F-E14); -1 without one
  double newPlaceProbability = 0.0;
  std::optional<RobotPose> pose;       ///< none where nothing measures lengths, or before the first place
  std::vector<Hypothesis> hypotheses;  ///< best first
  bool closure = false;                ///< a loop edge was added
  int closuresDropped = 0;             ///< loop edges that left the map: the graph denies them
  int closuresRestored = 0;            ///< closures refused before that entered the map
  std::vector<base::PlaceId> learnt;   ///< places that remembered or forgot at this image
  MemoryChange memory;                 ///< of these places together
  struct StepTime {
    std::string step;
    double milliseconds = 0.0;
  };
  std::vector<StepTime> times;  ///< wall time of each step, in order
  double milliseconds = 0.0;    ///< wall time of the whole image
  std::optional<LiveState> live;
};

}  // namespace engram::types

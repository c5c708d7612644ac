// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/memory/place_memory.h"
#include "engram/pipeline/dead_reckoning.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/pass_gate.h"
#include "engram/pipeline/perception.h"
#include "engram/pipeline/place_match.h"
#include "engram/pipeline/recogniser.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <memory>

namespace engram::pipeline {

/// Says at every image where the robot is in a finished map (F-20, A-14). The map is frozen; or, when asked
/// to adapt, its places remember what they are verified to look like, and nothing else changes.
class Localizer {
 public:
  /// Throws base::Error for an empty map or a calibration that cannot be read.
  Localizer(const PipelineParams& params, map::TopologicalMap map, bool adapt = false);

  /// Throws base::Error when the first image contradicts the calibration.
  types::FrameReport process(const types::Frame& frame);
  /// The same for features that Perception extracted before: the images of the frame are not looked at.
  types::FrameReport process(const types::Frame& frame, types::Features features);

  /// The robot is lost: every place is equally likely again, and how it got here says nothing.
  void restart();

  /// To be called at the end of a drive: the last places learn what they were seen to look like.
  std::vector<base::PlaceId> finish();

  const map::TopologicalMap& map() const { return map_; }
  map::TopologicalMap& map() { return map_; }
  /// What this configuration asks of a map.
  map::MapHeader header() const { return perception_.mapHeader(params_.memory.memory); }
  /// What the pairs so far say of the eyes of a stereo camera; none for another camera.
  std::optional<odometry::StereoHealth> eyes() const { return perception_.eyes(); }

 private:
  struct Work;
  /// A view that a place is to learn once the robot has left its surroundings.
  struct Lesson {
    base::PlaceId place;
    types::Features view;
  };

  bool perceive(Work& work);
  types::FrameReport locate(Work& work);
  void move(Work& work);
  void recognise(Work& work);
  void verify(Work& work);
  bool tryPlace(Work& work, types::Hypothesis& hypothesis, int inliers);
  void follow(Work& work);
  void remember(Work& work);
  void learnDistant(types::FrameReport& report);
  void learn(const Lesson& lesson, types::FrameReport& report);
  bool believable(base::PlaceId place, const PlaceMatch& match) const;
  bool agreesWithMotion(base::PlaceId place) const;

  PipelineParams params_;
  Perception perception_;
  std::unique_ptr<memory::MemoryModel> memory_;
  PassGate gate_;
  Recogniser recogniser_;
  DeadReckoning reckoning_;      // from the place accepted last
  base::PlaceId last_;           // that place
  double sinceLast_ = 0.0;       // [m] travelled since
  bool restarted_ = false;       // since the last image
  double sinceLearning_ = 0.0;   // [m] travelled since a place last learnt
  std::vector<Lesson> lessons_;  // in the order of their images
  int agreeing_ = 0;             // accepted images in a row that agree with the motion between them
  map::TopologicalMap map_;
  bool adapt_;
};

}  // namespace engram::pipeline

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/odometry/stereo_check.h"
#include "engram/pipeline/odometry_watch.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/recipe.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace engram::pipeline {

struct Run;
struct Steps;

/// Builds or extends a map, or says where the robot is in it, image by image: ten steps in one order, each a
/// strategy that the recipe of the configuration names.
class Pipeline {
 public:
  /// @param map empty, or a map to extend: the robot then starts at an unknown place of it. To localise in it
  /// must not be empty.
  /// Throws base::Error on a calibration or vocabulary that cannot be read, base::ConfigError on parameters
  /// that are out of range or do not suit each other.
  explicit Pipeline(const PipelineParams& params, map::TopologicalMap map = {}, Use use = Use::kBuild);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;

  /// @param features that Perception extracted before: the images of the frame are then not looked at. Not
  /// for recipes that look at both images of a pair. Throws base::Error when the first image contradicts the
  /// calibration.
  types::FrameReport process(const types::Frame& frame, std::optional<types::Features> features = {});

  /// The robot is lost: every place is equally likely again, and how it got here says nothing.
  void restart();
  /// To be called at the end of a drive: the last places learn what they were seen to look like, and the
  /// whole graph is relaxed once more, as the recipe has it. Returns the places that have learnt.
  std::vector<base::PlaceId> finish();

  /// What the next one to open the map would have to work out of it again: for MapFile::keep(). To be called
  /// after finish().
  std::vector<map::DerivedRow> derived();

  const map::TopologicalMap& map() const;
  /// A keeper of the map knows that these places are not the same ground, whatever they look like: no closure
  /// joins them, nor places up to two edges from them. In maps of places.
  void keepApart(std::vector<std::pair<base::PlaceId, base::PlaceId>> places);
  /// Keeps the true pose of a place, for evaluation.
  void survey(base::PlaceId place, const Eigen::Isometry3d& T_world_place);
  /// Hands over the map; the pipeline is not to be used again.
  map::TopologicalMap release() &&;

  /// The number of this drive in the map, from 0.
  int session() const;
  /// What the map must be opened with again.
  map::MapHeader header() const;
  /// What the pairs so far say of the eyes of a stereo camera; none for another camera.
  std::optional<odometry::StereoHealth> eyes() const;
  /// What wheel odometry was worth so far.
  const OdometryHealth& wheels() const;

 private:
  std::unique_ptr<Run> run_;
  std::unique_ptr<Steps> steps_;
};

}  // namespace engram::pipeline

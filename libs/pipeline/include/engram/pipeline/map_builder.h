// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/odometry/stereo_check.h"
#include "engram/pipeline/params.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <memory>
#include <optional>

namespace engram::pipeline {

/// Builds or extends a map, image by image.
class MapBuilder {
 public:
  virtual ~MapBuilder() = default;

  /// Learns from the next image. Throws base::Error when the first image contradicts the calibration.
  virtual types::FrameReport process(const types::Frame& frame) = 0;
  /// To be called at the end of a drive: relaxes the whole graph once more.
  virtual void finish() = 0;

  virtual const map::TopologicalMap& map() const = 0;
  /// For the store and for evaluation (surveyed poses).
  virtual map::TopologicalMap& map() = 0;
  /// The number of this drive in the map, from 0.
  virtual int session() const = 0;
  /// What the map must be opened with again.
  virtual map::MapHeader header() const = 0;
  /// What the pairs so far say of the eyes of a stereo camera; none for another camera.
  virtual std::optional<odometry::StereoHealth> eyes() const = 0;
};

/// By `[mapping] nodes`: `places` makes a Mapper, `views` a ViewMapper. Throws as their constructors.
std::unique_ptr<MapBuilder> makeMapBuilder(const PipelineParams& params, map::TopologicalMap map = {});

}  // namespace engram::pipeline

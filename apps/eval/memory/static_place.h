// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "engram/base/params.h"
#include "engram/evaluation/bootstrap.h"
#include "memory/memory_lab.h"

#include <string>
#include <vector>

namespace engram::apps {

/// Section `[static_place]`: a robot that stands at one place for days (F-24).
struct StaticPlaceParams {
  int days = 5;                    ///< one after another
  int images = 36;                 ///< a day, evenly from 8 to 22 h
  double jitter = 0.03;            ///< of the position, one sigma along x and y [m]
  double jitter_heading = 0.0349;  ///< one sigma [rad]
  int people = 6;                  ///< walking about on the tour's way
  double poster_share = 0.05;      ///< of the posters replaced overnight
  double furniture_share = 0.1;    ///< of the furniture moved overnight

  void describe(base::Params& p);
};

/// How one memory did at one place.
struct StaticPlaceResult {
  std::string place;   ///< `window` or `inside`
  std::string method;  ///< a memory that learns, or `static`
  world::Pose2 T_world_robot;
  /// F eq (8) over verified matches of every image but the first, in order, against the memory that has
  /// learnt from the verified ones before it; against the first image for ever with `static`. 0 where
  /// geometry refuses.
  std::vector<double> similarities;
  int learnt = 0;             ///< images that geometry confirmed as the product asks
  evaluation::Interval mean;  ///< 95 %, days drawn as blocks
};

/// How much of the windows is seen from a point on the floor: the sum of 1 / distance² over the window cells
/// in sight; walls and doors hide.
double windowExposure(const world::Plan& plan, double x, double y);

/// Similarities of views to a memory that learns from those before them.
/// @param views in order; the first one starts the memory. @param learnt how many were learnt from, if asked
std::vector<double> similaritiesOf(const std::vector<types::Features>& views,
                                   const pipeline::PipelineParams& params, int* learnt = nullptr);

/// F-24: the station of the tour that sees most of the windows, and the first one that sees least of them,
/// with every method. The features of each day stay in `static_place` of the folder. Throws
/// base::Interrupted.
std::vector<StaticPlaceResult> staticPlace(const StaticPlaceParams& params, const std::string& preset,
                                           const pipeline::PipelineParams& pipeline, const Workplace& place);

ResultTable tableOf(const std::vector<StaticPlaceResult>& results);
/// The table beside the paper's figures.
std::string toText(const std::vector<StaticPlaceResult>& results);

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/kept_drive.h"
#include "common/workplace.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/params.h"
#include "engram/world/world.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace engram::apps {

/// Section `[scans_world]`: the drive of Bertolli et al. on the simulator, and their filter on simulated
/// measurements.
struct ScansWorldParams {
  std::string building = "rooms";
  double scale = 1;                       ///< size of the images, of those of the camera
  int seeds = 50;                         ///< runs of the filter over which NEES is summed
  std::string sizes = "50,126,300,1000";  ///< reference scans of the comparison with the graph
  void describe(base::Params& p);
};

/// A reference as the map had it at some time: where, how certain, and its points in the plane.
struct DrawnScan {
  Eigen::Vector2d position = Eigen::Vector2d::Zero(), truth = position;  ///< [m], in the map
  Eigen::Matrix2d cov = Eigen::Matrix2d::Zero();  ///< of the position [m²]; zero where nothing keeps one
  std::vector<Eigen::Vector2d> points;
};
struct MapPicture {
  std::size_t image = 0;
  std::vector<DrawnScan> scans;
  double ate = 0;  ///< of the references' positions after alignment in the plane [m]
};

/// One drive by one back-end.
struct ScanRun {
  std::string backEnd;
  int images = 0, references = 0, points = 0, recognised = 0, refused = 0, closures = 0;
  std::vector<double> pointsOf;       ///< of each reference
  double ateOpen = 0, ateClosed = 0;  ///< [m] of the references before the first closure, and at the end
  double msPerImage = 0;              ///< CPU, with perception
  double relaxMs = 0;                 ///< CPU a taken-up image, of Decide and Relax
  std::vector<MapPicture> pictures;   ///< three on the way, before the first closure, at the end
};

/// Windowed matches against matches by descriptor alone, between references that an edge joins.
struct WindowFigures {
  int pairs = 0;
  double windowMs = 0, fullMs = 0;            ///< CPU a pair, of matching
  double windowInliers = 0, fullInliers = 0;  ///< mean share of the matches that agree with one motion
  double windowMatches = 0, fullMatches = 0;
};

struct ScansWorldResult {
  double length = 0;          ///< of the drive [m]
  std::vector<ScanRun> runs;  ///< the filter, the graph
  WindowFigures window;
};

/// Renders the drive once and maps it by both back-ends. Throws base::Interrupted on Ctrl-C.
ScansWorldResult runScansWorld(const ScansWorldParams& params, const world::WorldParams& world,
                               const pipeline::PipelineParams& pipeline, const Workplace& place);

}  // namespace engram::apps

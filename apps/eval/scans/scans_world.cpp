// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scans/scans_world.h"

#include "common/cpu_clock.h"
#include "engram/base/atomic_file.h"
#include "engram/base/progress.h"
#include "engram/cameras/rectifier.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/evaluation/trajectory_error.h"
#include "engram/features/matching.h"
#include "engram/pipeline/pipeline.h"
#include "engram/posegraph/scan_filter.h"

#include <algorithm>

namespace engram::apps {
namespace {

struct Eye {
  world::Eyes eyes;
  pipeline::PipelineParams pipeline;
};

Eye makeEye(double scale, const pipeline::PipelineParams& pipeline, const Workplace& place) {
  Eye eye{world::presetEyes("stereo"), pipeline};
  const auto smaller = [scale](const cameras::CameraRig& rig) {
    cameras::CameraRig small = cameras::makeRig(rig.camera->scaled(scale, scale));
    small.T_robot_cam = rig.T_robot_cam;
    return small;
  };
  if (scale != 1) {
    eye.eyes.left = smaller(eye.eyes.left);
    eye.eyes.right = smaller(*eye.eyes.right);
  }
  eye.pipeline.camera.file = place.file("camera.ini");
  base::writeText(eye.pipeline.camera.file,
                  cameras::toText(cameras::StereoRig{eye.eyes.left, *eye.eyes.right}), true);
  return eye;
}

/// The points of a scan in the plane of the map.
std::vector<Eigen::Vector2d> pointsOf(const map::Place& place, const cameras::Rectifier& rectifier) {
  std::vector<Eigen::Vector2d> points;
  const types::Features& scan = place.memory->features;
  const Eigen::Isometry3d T_map_eye = place.T_map_place * rectifier.T_robot_cam();
  for (std::size_t i = 0; i < scan.size(); ++i)
    points.push_back((T_map_eye * rectifier.model().toPoint(types::stereoPoint(
                                      scan.keypoints[i], scan.ranges[i], rectifier.model())))
                         .head<2>());
  return points;
}

MapPicture pictureOf(const map::TopologicalMap& map, const KeptDrive& drive,
                     const cameras::Rectifier& rectifier, std::size_t image) {
  MapPicture picture{image, {}, 0};
  evaluation::Trajectory estimate, truth;
  for (const auto& [id, place] : map.places()) {
    const auto pose = evaluation::poseAt(drive.truth, place.createdStamp);
    if (!pose) continue;
    estimate.push_back({static_cast<double>(estimate.size()), place.T_map_place});
    truth.push_back({static_cast<double>(truth.size()), *pose});
  }
  const auto error = evaluation::ate(estimate, truth, evaluation::Alignment::kSe2);
  if (!error) return picture;
  picture.ate = error->rmse;
  std::size_t k = 0;
  for (const auto& [id, place] : map.places()) {
    DrawnScan scan;
    scan.position = place.T_map_place.translation().head<2>();
    scan.points = pointsOf(place, rectifier);
    if (k < truth.size())
      scan.truth = (error->T_truth_estimate.inverse() * truth[k++].T_world_body.translation()).head<2>();
    if (!place.joint.empty()) scan.cov = posegraph::positionCovariance(place.joint.own(), place.T_map_place);
    picture.scans.push_back(std::move(scan));
  }
  return picture;
}

ScanRun mapDrive(const KeptDrive& drive, const pipeline::PipelineParams& params,
                 const cameras::Rectifier& rectifier, map::TopologicalMap& out) {
  ScanRun run;
  run.backEnd = params.posegraph.relaxer;
  pipeline::Pipeline mapper(params);
  double seconds = 0, back = 0;
  int taken = 0;
  map::TopologicalMap open;  // with the reference made last before the first closure
  const std::size_t n = drive.truth.size();
  const auto draw = [&](const map::TopologicalMap& map, std::size_t image) {
    run.pictures.push_back(pictureOf(map, drive, rectifier, image));
  };
  drive.forEachFrame([&](const types::Frame& frame) {
    const auto image = static_cast<std::size_t>(run.images++);
    const double before = threadSeconds();
    const types::FrameReport report = mapper.process(frame);
    seconds += threadSeconds() - before;
    taken += report.outcome != types::Outcome::kSkipped && report.outcome != types::Outcome::kUnusable;
    run.recognised += report.outcome == types::Outcome::kRecognised;
    run.refused += report.outcome == types::Outcome::kRefused;
    for (const auto& step : report.times)
      if (step.step == "decide" || step.step == "relax") back += step.milliseconds;
    if (report.closure && run.closures++ == 0) {
      run.pictures.push_back(pictureOf(open, drive, rectifier, image));
      run.ateOpen = run.pictures.back().ate;
    }
    if (run.closures == 0 && report.outcome == types::Outcome::kNewPlace) {
      mapper.finish();  // covariances come with it
      open = mapper.map();
    }
    if (run.closures == 0 && (image + 1) % std::max<std::size_t>(1, n / 4) == 0) {
      mapper.finish();
      draw(mapper.map(), image);
    }
  });
  mapper.finish();
  draw(mapper.map(), n);
  run.ateClosed = run.pictures.back().ate;
  for (const auto& [id, place] : mapper.map().places())
    run.pointsOf.push_back(static_cast<double>(place.memory->features.size()));
  run.references = static_cast<int>(run.pointsOf.size());
  for (const double points : run.pointsOf) run.points += static_cast<int>(points);
  run.msPerImage = 1000 * seconds / std::max(1, run.images);
  run.relaxMs = back / std::max(1, taken);
  out = mapper.map();
  return run;
}

/// Both ways of matching on all pairs of references that an edge joins, predicted by the map.
WindowFigures compareWindows(const map::TopologicalMap& map, const pipeline::PipelineParams& params,
                             const cameras::Rectifier& rectifier) {
  WindowFigures figures;
  for (const auto& [id, edge] : map.edges()) {
    if (edge.correspondences.empty()) continue;
    const types::Features& a = map.place(edge.a).memory->features;
    const types::Features& b = map.place(edge.b).memory->features;
    const Eigen::Isometry3d mount = rectifier.T_robot_cam();
    const Eigen::Isometry3d T_a_b =
        mount.inverse() * map.place(edge.a).T_map_place.inverse() * map.place(edge.b).T_map_place * mount;
    const auto share = [&](const std::vector<types::Match>& matches) {
      const auto found = geometry::verifyStereo(a, b, matches, rectifier.model(), params.stereo);
      return matches.empty() ? 0.0 : static_cast<double>(found.inliers.size()) / matches.size();
    };
    double start = threadSeconds();
    const auto near = odometry::matchScans(a, b, T_a_b, rectifier.model(), params.scans.match);
    figures.windowMs += 1000 * (threadSeconds() - start);
    start = threadSeconds();
    const auto all = features::match(a, b, params.match);
    figures.fullMs += 1000 * (threadSeconds() - start);
    figures.windowInliers += share(near);
    figures.fullInliers += share(all);
    figures.windowMatches += static_cast<double>(near.size());
    figures.fullMatches += static_cast<double>(all.size());
    ++figures.pairs;
  }
  for (double* sum : {&figures.windowMs, &figures.fullMs, &figures.windowInliers, &figures.fullInliers,
                      &figures.windowMatches, &figures.fullMatches})
    *sum /= std::max(1, figures.pairs);
  return figures;
}

}  // namespace

void ScansWorldParams::describe(base::Params& p) {
  p.add("building", building, "preset of the drive: room, corridor, room and back");
  p.add("scale", scale, "size of the images, of those of the camera", {0.1, 1});
  p.add("seeds", seeds, "runs of the filter on simulated measurements, for NEES", {2, 10000});
  p.add("sizes", sizes, "reference scans of the comparison of filter and graph, separated by commas");
}

ScansWorldResult runScansWorld(const ScansWorldParams& params, const world::WorldParams& worldParams,
                               const pipeline::PipelineParams& pipeline, const Workplace& place) {
  place.subfolder("drives");
  const Eye eye = makeEye(params.scale, pipeline, place);
  const world::World world = world::World::preset(params.building, worldParams);
  base::Progress progress(place.progress, "drive");
  const KeptDrive drive = keepDrive(world, eye.eyes, 1, place.file("drives/rooms"), place.threads,
                                    [&](double share) { progress.update(share, 0); });
  const cameras::Rectifier rectifier(cameras::loadStereoRig(eye.pipeline.camera.file));
  ScansWorldResult result;
  result.length = drive.arcs.back() - drive.arcs.front();
  map::TopologicalMap filtered, relaxed;
  result.runs.push_back(mapDrive(drive, eye.pipeline, rectifier, filtered));
  pipeline::PipelineParams graph = eye.pipeline;
  graph.posegraph.relaxer = "ceres";
  result.runs.push_back(mapDrive(drive, graph, rectifier, relaxed));
  result.window = compareWindows(filtered, eye.pipeline, rectifier);
  return result;
}

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_mapping.h"

#include "common/cpu_clock.h"
#include "engram/evaluation/trajectory_error.h"
#include "engram/map/graph.h"
#include "engram/pipeline/pipeline.h"

#include <algorithm>
#include <cmath>

namespace engram::apps {
namespace {

using evaluation::Trajectory;
using Poses = std::map<base::PlaceId, Eigen::Isometry3d>;

/// The robot's path when the places stand at `poses`.
Trajectory pathAt(const map::TopologicalMap& map, const Poses& poses) {
  Trajectory path;
  for (const auto& point : map.path())
    path.push_back({point.stamp, poses.at(point.anchor) * point.T_anchor_robot});
  return path;
}

/// The places as they were entered: each where odometry put it, seen from a place before it. One that no
/// odometry leads to is put where the rest of the graph says.
Poses asEntered(const posegraph::Graph& graph) {
  posegraph::Graph tree;
  if (graph.poses.empty()) return {};
  tree.poses.insert(*graph.poses.begin());
  for (const auto& c : graph.constraints)
    if (!c.robust) tree.constraints.push_back(c);
  posegraph::addMissingPoses(tree);
  tree.constraints = graph.constraints;
  posegraph::addMissingPoses(tree);
  return tree.poses;
}

struct Fitted {
  double rmse = 0;
  MappingRun::Path path;  ///< in the frame of the truth
};

Fitted fit(const Trajectory& estimate, const Trajectory& truth) {
  Fitted fitted;
  const auto error = evaluation::ate(estimate, truth, evaluation::Alignment::kSe2);
  if (!error) return fitted;
  fitted.rmse = error->rmse;
  for (const auto& pose : estimate)
    fitted.path.push_back((error->T_truth_estimate * pose.T_world_body).translation().head<2>());
  return fitted;
}

double headingBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return std::abs(Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle());
}

/// Maps the drive and counts.
class MappingExperiment {
 public:
  MappingExperiment(const KeptDrive& drive, const pipeline::PipelineParams& params, double rightWithin)
      : drive_(drive), mapper_(params), rightWithin_(rightWithin) {}

  void run(MappingRun& run) {
    drive_.forEachFrame([&](const types::Frame& frame) { see(frame, run); });
    const double start = threadSeconds();
    mapper_.finish();
    run.cpuSeconds += threadSeconds() - start;
    run.places = static_cast<int>(mapper_.map().places().size());
    for (std::size_t k = 0; k < edges_.size(); ++k) run.closures[k].kept = holds(edges_[k]);
  }

  const map::TopologicalMap& map() const { return mapper_.map(); }
  const Trajectory& odometry() const { return odometry_; }

 private:
  void see(const types::Frame& frame, MappingRun& run) {
    const double start = threadSeconds();
    const types::FrameReport report = mapper_.process(frame);
    run.cpuSeconds += threadSeconds() - start;
    ++run.frames;
    run.restored += report.closuresRestored;
    if (report.outcome == types::Outcome::kSkipped || report.outcome == types::Outcome::kUnusable) return;
    ++run.images;
    odometry_.push_back({frame.stamp, *frame.T_odom_robot});
    if (report.outcome != types::Outcome::kRecognised) return;
    const ClosureRecord record = judge(frame, report.place);
    ++run.recognised;
    run.recognisedWrong += !record.right;
    if (!report.closure) return;
    run.closures.push_back(record);
    edges_.push_back(newestLoopAt(report.place));
  }

  using Ends = std::pair<base::PlaceId, base::PlaceId>;

  static bool closes(const map::Edge& edge) {
    return edge.type == map::EdgeType::kLoop || edge.type == map::EdgeType::kRecognition;
  }

  Ends newestLoopAt(base::PlaceId place) const {
    Ends ends;
    for (const auto& [id, edge] : mapper_.map().edges())
      if (closes(edge) && edge.b == place) ends = {edge.a, edge.b};
    return ends;
  }

  /// An edge that was dropped and came back has another id.
  bool holds(const Ends& ends) const {
    const auto& edges = mapper_.map().edges();
    return std::any_of(edges.begin(), edges.end(), [&](const auto& e) {
      return closes(e.second) && Ends{e.second.a, e.second.b} == ends;
    });
  }

  ClosureRecord judge(const types::Frame& frame, base::PlaceId id) const {
    const map::Place& place = mapper_.map().place(id);
    const Eigen::Isometry3d& T_world_robot = drive_.truth.at(frame.index).T_world_body;
    const Eigen::Isometry3d& T_world_place = drive_.truth.at(place.createdIndex).T_world_body;
    ClosureRecord record;
    record.image = frame.index;
    record.place = id.value;
    record.placeImage = place.createdIndex;
    record.distance = (T_world_robot.translation() - T_world_place.translation()).norm();
    record.turn = headingBetween(T_world_robot, T_world_place);
    record.right = record.distance <= rightWithin_;
    record.position = T_world_robot.translation().head<2>();
    return record;
  }

  const KeptDrive& drive_;
  pipeline::Pipeline mapper_;
  double rightWithin_;
  Trajectory odometry_;
  std::vector<Ends> edges_;  // of the closures
};

/// The map as it was entered, relaxed once by each relaxer.
void relaxByEach(const map::TopologicalMap& map, const Poses& before, const Trajectory& truth,
                 posegraph::RelaxerParams params, MappingRun& run) {
  posegraph::Graph graph = map::toGraph(map);
  graph.poses = before;
  for (const std::string& name : comparedRelaxers()) {
    params.relaxer = name;
    RelaxerResult result;
    const double start = threadSeconds();
    const posegraph::Relaxation relaxed = posegraph::makeRelaxer(params)->relax(graph);
    result.cpuSeconds = threadSeconds() - start;
    if (relaxed.ending != posegraph::Ending::kFailed) {
      const Fitted fitted = fit(pathAt(map, relaxed.poses), truth);
      result.ate = fitted.rmse;
      if (name == comparedRelaxers().front()) run.relaxed = fitted.path;
    }
    run.after[name] = result;
  }
}

}  // namespace

const std::vector<std::string>& comparedRelaxers() {
  static const std::vector<std::string> names{"ceres", "duckett", "mrpt_levmarq"};
  return names;
}

int MappingRun::closuresThatAre(bool right) const {
  return static_cast<int>(std::count_if(closures.begin(), closures.end(),
                                        [&](const ClosureRecord& c) { return c.kept && c.right == right; }));
}

int MappingRun::dropped() const {
  return static_cast<int>(
      std::count_if(closures.begin(), closures.end(), [](const ClosureRecord& c) { return !c.kept; }));
}

MappingRun mapDrive(const std::string& building, const KeptDrive& drive,
                    const pipeline::PipelineParams& params, double rightWithin) {
  MappingRun run;
  run.building = building;
  run.length = drive.arcs.back();
  run.seconds = drive.truth.back().stamp - drive.truth.front().stamp;
  MappingExperiment experiment(drive, params, rightWithin);
  experiment.run(run);

  const Fitted odometry = fit(experiment.odometry(), drive.truth);
  run.ateOdometry = odometry.rmse;
  run.odometry = odometry.path;
  for (const auto& pose : experiment.odometry())
    run.truth.push_back(evaluation::poseAt(drive.truth, pose.stamp)->translation().head<2>());
  const map::TopologicalMap& map = experiment.map();
  const posegraph::Graph graph = map::toGraph(map);
  run.ateMap = fit(pathAt(map, graph.poses), drive.truth).rmse;
  const Poses entered = asEntered(graph);
  const Fitted before = fit(pathAt(map, entered), drive.truth);
  run.ateBefore = before.rmse;
  run.before = before.path;
  relaxByEach(map, entered, drive.truth, params.posegraph, run);
  return run;
}

}  // namespace engram::apps

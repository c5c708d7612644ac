// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/map_truth.h"

#include "engram/base/error.h"
#include "engram/evaluation/trajectory_error.h"
#include "engram/map/joined_path.h"
#include "engram/types/se3.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace engram::apps {
namespace {

evaluation::FrameRef reference(const types::FrameReport& report) {
  return {report.index, report.label, report.stamp, std::nullopt};
}

evaluation::FrameRef reference(const map::Place& place) {
  evaluation::FrameRef ref{place.createdIndex, place.createdLabel, place.createdStamp, std::nullopt};
  if (place.T_world_place) ref.position = place.T_world_place->translation();
  return ref;
}

}  // namespace

MapTruth::MapTruth(const std::string& path, const evaluation::TruthOptions& options)
    : truth_(evaluation::Truth::load(path, options)) {
  if (hasPoses()) poses_ = evaluation::readPoses(path);
}

void MapTruth::note(const types::FrameReport& report) { match_.addImage(truth_, reference(report)); }

void MapTruth::requireMatch(const map::TopologicalMap& map, std::ostream& notices) const {
  evaluation::TruthMatch match = match_;
  for (const auto& [id, place] : map.places()) match.addPlace(truth_, reference(place));
  if (const auto problem = match.problem(truth_); !problem.empty())
    throw base::Error(problem + ". What else was done is kept");
  if (const auto notice = match.notice(truth_); !notice.empty()) notices << notice << "\n";
}

void MapTruth::survey(pipeline::Pipeline& mapper, const types::FrameReport& report) {
  note(report);
  if (!hasPoses() || report.outcome != types::Outcome::kNewPlace) return;
  if (!mapper.map().places().contains(report.place)) return;          // it came and went
  const double made = mapper.map().place(report.place).createdStamp;  // of an earlier image, perhaps
  if (const auto pose = evaluation::poseAt(poses_, made)) mapper.survey(report.place, *pose);
}

evaluation::Verdict MapTruth::judgeClosure(const map::TopologicalMap& map, const types::FrameReport& report,
                                           base::PlaceId place) const {
  return truth_.judge(reference(report), reference(map.place(place)));
}

void MapTruth::readPlaces(const map::TopologicalMap& map) {
  if (!hasPoses()) return;
  for (const auto& [id, place] : map.places()) {
    if (!place.T_world_place)
      throw base::Error("place " + std::to_string(id.value) +
                        " of the map has no true pose; make the map with engram-slam --truth");
    ids_.push_back(id);
    surveyed_.positions.push_back(place.T_world_place->translation());
  }
  const auto indexOf = [&](base::PlaceId id) {
    return static_cast<int>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  };
  std::vector<std::pair<int, int>> edges;
  for (const auto& [id, edge] : map.edges())
    if (map::isPassage(edge.type)) edges.emplace_back(indexOf(edge.a), indexOf(edge.b));
  surveyed_.adjacency = belief::Adjacency::fromEdges(ids_.size(), edges);
}

Judgement MapTruth::judge(const map::TopologicalMap& map, const types::FrameReport& report,
                          base::PlaceId place, double peak) const {
  if (!hasPoses()) return {truth_.judge(reference(report), reference(map.place(place))), std::nullopt};
  const auto index = static_cast<int>(std::lower_bound(ids_.begin(), ids_.end(), place) - ids_.begin());
  const auto error = evaluation::placeError(truth_, report.stamp, surveyed_, index,
                                            peak < 0 ? static_cast<double>(index) : peak);
  if (!error) return {};
  return {error->verdict, error->places};
}

bool MapTruth::answerable(const types::FrameReport& report) const {
  return truth_.answerable(reference(report));
}

std::optional<PoseError> MapTruth::poseError(const map::TopologicalMap& map,
                                             const types::FrameReport& report) const {
  if (!report.pose || !hasPoses() || !map.places().contains(report.pose->place)) return std::nullopt;
  const auto& T_world_place = map.place(report.pose->place).T_world_place;
  const auto truth = evaluation::poseAt(poses_, report.stamp);
  if (!T_world_place || !truth) return std::nullopt;
  const types::RelPose& found = report.pose->T_place_robot;
  const types::Vector6d off = types::logSe3((*T_world_place * found.T_a_b).inverse() * *truth);
  const Eigen::Vector3d error(off[0], off[1], off[5]);
  const std::vector<int> plane{0, 1, 5};
  const Eigen::Matrix3d cov = found.cov(plane, plane);
  return PoseError{error.head<2>().norm(), std::abs(error[2]), error.dot(cov.llt().solve(error)) / 3};
}

std::optional<PathError> trajectoryError(const map::TopologicalMap& map, int session,
                                         const evaluation::Trajectory& truth) {
  std::vector<map::PathPoint> drive;
  for (const auto& point : map.path())
    if (point.session == session) drive.push_back(point);
  const map::JoinedPath joined = map::joinedPath(map, drive);
  evaluation::Trajectory path;
  for (const auto& point : joined.points)
    if (path.empty() || point.stamp > path.back().stamp)
      path.push_back({point.stamp, map.T_map_robot(point)});
  const auto error = evaluation::ate(path, truth, evaluation::Alignment::kSe2);
  if (!error) return std::nullopt;
  return PathError{error->rmse, joined.apart};
}

}  // namespace engram::apps

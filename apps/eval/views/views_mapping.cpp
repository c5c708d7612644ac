// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "views/views_mapping.h"

#include "common/cpu_clock.h"
#include "engram/evaluation/trajectory_error.h"
#include "engram/map/joined_path.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"

#include <cmath>
#include <filesystem>

namespace engram::apps {
namespace {

/// Calls `see` with the images of the window, in order; covered ones are black.
template <class See>
void forEachShown(const ShownDrive& shown, See see) {
  const auto n = static_cast<double>(shown.drive->truth.size());
  std::size_t i = 0;
  shown.drive->forEachFrame([&](const types::Frame& original) {
    const std::size_t at = i++;
    if (at < std::floor(shown.from * n) || at >= std::ceil(shown.to * n)) return;
    types::Frame frame = original;
    for (const auto& [first, end] : shown.covered) {
      if (at < first || at >= end) continue;
      frame.image = cv::Mat(frame.image.size(), frame.image.type(), cv::Scalar::all(0));  // new pixels
      frame.right = frame.image;
    }
    if (!shown.wheels) frame.T_odom_robot.reset();
    see(frame, shown.drive->truth[at].T_world_body);
  });
}

int partsOf(const map::TopologicalMap& map) {
  std::set<base::PlaceId> seen;
  int parts = 0;
  for (const auto& [id, place] : map.places()) {
    if (seen.contains(id)) continue;
    ++parts;
    for (const auto& [member, hops] : map.hopDistances(id, static_cast<int>(map.places().size())))
      seen.insert(member);
  }
  return parts;
}

int weakLinks(const map::TopologicalMap& map) {
  int weak = 0;
  for (const auto& [id, edge] : map.edges()) weak += edge.type == map::EdgeType::kWeak;
  return weak;
}

}  // namespace

ViewMapping::ViewMapping(const pipeline::PipelineParams& params, std::string file, double falseDistance,
                         double falseAngle)
    : params_(params), file_(std::move(file)), falseDistance_(falseDistance), falseAngle_(falseAngle) {
  std::filesystem::remove(file_);
}

bool ViewMapping::isFalse(const map::TopologicalMap& map, const map::Edge& edge) const {
  const auto& a = map.place(edge.a).T_world_place;
  const auto& b = map.place(edge.b).T_world_place;
  const Eigen::Isometry3d error = edge.T_a_b.T_a_b.inverse() * (a->inverse() * *b);
  return error.translation().norm() > falseDistance_ ||
         Eigen::AngleAxisd(error.linear()).angle() > falseAngle_;
}

ViewSession ViewMapping::add(const ShownDrive& shown) {
  ViewSession session;
  const int keep = params_.upkeep.keep_drives;
  if (keep > 0) map_.forgetPath(map_.nextSession() - keep);
  map::Cursor stored = map_.now();
  pipeline::Pipeline mapper(params_, std::move(map_));
  auto file = std::filesystem::exists(file_) ? store::MapFile::open(file_, store::Access::kReadWrite)
                                             : store::MapFile::create(file_, mapper.header());
  const map::TopologicalMap& map = mapper.map();
  evaluation::Trajectory& truth = truth_[mapper.session()];
  std::uint32_t seenEdges = map.content().nextEdge;
  std::map<std::string, std::pair<double, int>> steps;
  double viewMs = 0;
  bool failing = false;
  const double start = threadSeconds();

  forEachShown(shown, [&](const types::Frame& frame, const Eigen::Isometry3d& T_world_robot) {
    if (!truth.empty()) length_ += (truth.back().T_world_body.inverse() * T_world_robot).translation().norm();
    truth.push_back({frame.stamp, T_world_robot});
    const double before = threadSeconds();
    const types::FrameReport report = mapper.process(frame);
    const double ms = 1000 * (threadSeconds() - before);
    ++session.frames;
    for (const auto& step : report.times) {
      steps[step.step].first += step.milliseconds;
      ++steps[step.step].second;
    }
    const bool failed = report.outcome == types::Outcome::kUnusable;
    session.failures += failed && !failing;
    failing = failed;
    session.viewsForgotten += report.memory.pruned;
    if (report.outcome != types::Outcome::kNewPlace) return;
    ++session.viewsAdded;
    viewMs += ms;
    if (map.places().contains(report.place)) mapper.survey(report.place, T_world_robot);
    bool located = false;
    for (; seenEdges < map.content().nextEdge; ++seenEdges) {
      const auto edge = map.edges().find(base::EdgeId(seenEdges));
      if (edge == map.edges().end()) continue;
      const auto type = edge->second.type;
      session.weakMade += type == map::EdgeType::kWeak;
      if (type == map::EdgeType::kWeak || type == map::EdgeType::kCompounded) continue;
      session.links += type != map::EdgeType::kOdometry;
      located |= type == map::EdgeType::kRecognition;
      session.falseLinks += isFalse(map, edge->second);
    }
    session.located += located;
    file.commit(map, map.changesSince(stored));
  });
  mapper.finish();
  session.seconds = threadSeconds() - start;
  file.commit(map, map.changesSince(stored));
  file.close();
  session.bytes = std::filesystem::file_size(file_);
  map_ = std::move(mapper).release();
  for (const auto& [name, sum] : steps) session.stepMs[name] = sum.first / sum.second;
  session.msPerView = session.viewsAdded > 0 ? viewMs / session.viewsAdded : 0.0;
  session.weakLeft = weakLinks(map_);
  session.parts = partsOf(map_);
  session.views = static_cast<int>(map_.places().size());
  session.edges = static_cast<int>(map_.edges().size());
  return session;
}

/// Drives may overlap in time: each is paired with its own truth.
double ViewMapping::ate() const {
  evaluation::Trajectory estimate, truth;
  for (const auto& point : map::joinedPath(map_, map_.path()).points) {
    const auto pose = evaluation::poseAt(truth_.at(point.session), point.stamp);
    if (!pose) continue;
    const double number = static_cast<double>(estimate.size());
    estimate.push_back({number, map_.T_map_robot(point)});
    truth.push_back({number, *pose});
  }
  const auto error = evaluation::ate(estimate, truth, evaluation::Alignment::kSe3);
  return error ? error->rmse : std::numeric_limits<double>::quiet_NaN();
}

double ViewMapping::apart() const { return map::joinedPath(map_, map_.path()).apart; }

LocatedShare locateEach(const map::TopologicalMap& map, const ShownDrive& shown,
                        const pipeline::PipelineParams& params, double every, double rightWithin) {
  LocatedShare result;
  pipeline::Pipeline localizer(params, map, pipeline::Use::kFrozen);
  std::optional<Eigen::Isometry3d> last;
  double seconds = 0;
  forEachShown(shown, [&](const types::Frame& frame, const Eigen::Isometry3d& T_world_robot) {
    if (last && (last->inverse() * T_world_robot).translation().norm() < every) return;
    last = T_world_robot;
    localizer.restart();
    const double before = threadSeconds();
    const types::FrameReport report = localizer.process(frame);
    seconds += threadSeconds() - before;
    ++result.images;
    if (report.outcome != types::Outcome::kRecognised) return;
    ++result.accepted;
    const auto& T_world_place = map.place(report.place).T_world_place;
    result.right += (T_world_place->inverse() * T_world_robot).translation().norm() <= rightWithin;
  });
  result.msPerImage = result.images > 0 ? 1000 * seconds / result.images : 0.0;
  return result;
}

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

#include "engram/base/error.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"
#include "stereo_drive.h"

#include <gtest/gtest.h>

#include <sstream>

namespace engram::pipeline {
namespace {

using engram::testing::DriveFrames;
using engram::testing::firstStereoDrive;
using engram::testing::secondStereoDrive;
using engram::testing::stereoParams;
using map::EdgeType;

/// The drive without the counts of the wheels.
DriveFrames blind(DriveFrames drive) {
  for (auto& frame : drive.frames) frame.T_odom_robot.reset();
  return drive;
}

void cover(DriveFrames& drive, std::size_t first, std::size_t end) {
  for (std::size_t i = first; i < end; ++i) {
    auto& frame = drive.frames.at(i);
    frame.image = cv::Mat(frame.image.size(), frame.image.type(), cv::Scalar::all(0));  // new pixels
    frame.right = frame.image;
  }
}

/// Shows frames and surveys the views that they become.
std::vector<types::FrameReport> show(Pipeline& mapper, const DriveFrames& drive, std::size_t from = 0,
                                     std::size_t to = 1000) {
  std::vector<types::FrameReport> reports;
  for (std::size_t i = from; i < std::min(to, drive.frames.size()); ++i) {
    reports.push_back(mapper.process(drive.frames[i]));
    const auto& report = reports.back();
    if (mapper.map().places().contains(report.place)) mapper.survey(report.place, drive.T_world_robot[i]);
    mapper.map().checkInvariants();
  }
  mapper.finish();
  return reports;
}

map::TopologicalMap mapOf(const DriveFrames& drive, const PipelineParams& params = stereoParams()) {
  Pipeline mapper(params);
  show(mapper, drive);
  return mapper.map();
}

/// The first drive without wheels; made once.
const map::TopologicalMap& firstMap() {
  static const map::TopologicalMap map = mapOf(blind(firstStereoDrive()));
  return map;
}

int count(const map::TopologicalMap& map, EdgeType type) {
  int n = 0;
  for (const auto& [id, edge] : map.edges()) n += edge.type == type;
  return n;
}

/// How far a pose between two views is from the truth [m].
double errorOf(const map::TopologicalMap& map, base::PlaceId a, base::PlaceId b,
               const Eigen::Isometry3d& T_a_b) {
  const Eigen::Isometry3d truth = map.place(a).T_world_place->inverse() * *map.place(b).T_world_place;
  return (truth.inverse() * T_a_b).translation().norm();
}

double worstLink(const map::TopologicalMap& map) {
  double worst = 0;
  for (const auto& [id, e] : map.edges())
    if (e.type != EdgeType::kWeak) worst = std::max(worst, errorOf(map, e.a, e.b, e.T_a_b.T_a_b));
  return worst;
}

double meanLink(const map::TopologicalMap& map) {
  double sum = 0;
  for (const auto& [id, e] : map.edges()) sum += errorOf(map, e.a, e.b, e.T_a_b.T_a_b);
  return sum / static_cast<double>(map.edges().size());
}

/// Of the pose of every view, seen from the first.
double worstPose(const map::TopologicalMap& map) {
  const auto& first = map.places().begin()->second;
  double worst = 0;
  for (const auto& [id, place] : map.places())
    worst = std::max(worst, errorOf(map, first.id, id, first.T_map_place.inverse() * place.T_map_place));
  return worst;
}

bool isOnePart(const map::TopologicalMap& map) {
  return map.hopDistances(map.places().begin()->first, 100000).size() == map.places().size();
}

std::string dumpOf(const map::TopologicalMap& map) {
  std::ostringstream out;
  store::dump(out, {}, map.content(), {});
  return out.str();
}

TEST(ViewMapper, MakesViewsByK20AndLinksThem) {
  const DriveFrames drive = blind(firstStereoDrive());
  Pipeline mapper(stereoParams());
  const auto reports = show(mapper, drive);
  const auto& map = mapper.map();
  ASSERT_GE(map.places().size(), 10u);
  EXPECT_EQ(reports[0].reason, "the first image");
  EXPECT_EQ(reports[1].outcome, types::Outcome::kNewPlace) << "the first view, once it is confirmed";
  double last = -1;
  for (const auto& report : reports) {
    if (report.outcome != types::Outcome::kNewPlace) continue;
    EXPECT_TRUE(last < 0 || report.stamp - last >= 0.3);
    last = report.stamp;
  }
  EXPECT_EQ(count(map, EdgeType::kOdometry), static_cast<int>(map.places().size()) - 1);
  EXPECT_EQ(count(map, EdgeType::kWeak), 0);
  EXPECT_LT(meanLink(map), 0.05);
  EXPECT_LT(worstLink(map), 0.25) << "a point 3 m away is known to 0.6 m a pixel of disparity";
  EXPECT_LT(worstPose(map), 0.02 * drive.length());
  for (const auto& [id, place] : map.places()) {
    EXPECT_LE(place.memory->features.size(), 300u);
    for (const float range : place.memory->features.ranges) EXPECT_GT(range, 0.0f);
  }
}

TEST(ViewMapper, SameFramesGiveTheSameMapWhateverTheThreads) {
  PipelineParams params = stereoParams();
  const std::string one = dumpOf(mapOf(firstStereoDrive(), params));
  params.recognise.threads = 3;
  EXPECT_EQ(one, dumpOf(mapOf(firstStereoDrive(), params)));
}

TEST(ViewMapper, WakesUpAnywhereInTheMapAndJoinsIt) {
  Pipeline mapper(stereoParams(), firstMap());
  const std::size_t before = mapper.map().places().size();
  show(mapper, blind(secondStereoDrive()));
  const auto& map = mapper.map();
  EXPECT_GT(map.places().size(), before);
  EXPECT_EQ(mapper.session(), 1);
  EXPECT_GT(count(map, EdgeType::kRecognition), 0);
  EXPECT_EQ(count(map, EdgeType::kWeak), 0);
  EXPECT_TRUE(isOnePart(map));
  EXPECT_LT(meanLink(map), 0.05);
  EXPECT_LT(worstLink(map), 0.25);
  EXPECT_LT(worstPose(map), 0.2);
}

/// K-22, K-E11, K-E14: a drive that starts outside hangs on a weak link until it meets the map; then it moves
/// to where it belongs.
TEST(ViewMapper, ADriveFromOutsideHangsOnAWeakLinkUntilItMeetsTheMap) {
  const DriveFrames first = blind(firstStereoDrive()), second = blind(secondStereoDrive());
  DriveFrames end = first;  // a map of the last part alone
  end.frames.erase(end.frames.begin(), end.frames.begin() + 45);
  end.T_world_robot.erase(end.T_world_robot.begin(), end.T_world_robot.begin() + 45);
  Pipeline mapper(stereoParams(), mapOf(end));
  const auto reports = show(mapper, second, 0, 6);
  EXPECT_EQ(count(mapper.map(), EdgeType::kWeak), 1);
  EXPECT_FALSE(isOnePart(mapper.map()));
  EXPECT_EQ(mapper.map().components().size(), 1u) << "the weak link joins all";
  show(mapper, second, 6);
  EXPECT_EQ(count(mapper.map(), EdgeType::kWeak), 0);
  EXPECT_TRUE(isOnePart(mapper.map()));
  EXPECT_LT(worstPose(mapper.map()), 0.3);
}

/// K-E10: a covered camera makes one weak link, and no view of the dark.
TEST(ViewMapper, ARunOfFailuresLeavesOneWeakLink) {
  DriveFrames drive = blind(firstStereoDrive());
  cover(drive, 20, 34);
  Pipeline mapper(stereoParams());
  const auto reports = show(mapper, drive);
  EXPECT_EQ(count(mapper.map(), EdgeType::kWeak), 1);
  for (std::size_t i = 20; i < 34; ++i) {
    EXPECT_EQ(reports[i].outcome, types::Outcome::kUnusable) << i;
    EXPECT_NE(reports[i].reason.find("visual odometry failed"), std::string::npos) << reports[i].reason;
  }
  for (const auto& [id, edge] : mapper.map().edges())
    EXPECT_TRUE(edge.type != EdgeType::kWeak || edge.T_a_b.cov(0, 0) >= 100.0);
}

TEST(ViewMapper, WheelsBridgeWhatVisualOdometryCannot) {
  DriveFrames drive = firstStereoDrive();
  cover(drive, 20, 34);
  Pipeline mapper(stereoParams());
  show(mapper, drive);
  EXPECT_EQ(count(mapper.map(), EdgeType::kWeak), 0);
  EXPECT_TRUE(isOnePart(mapper.map()));
  EXPECT_LT(worstPose(mapper.map()), 0.2);

  PipelineParams params = stereoParams();
  params.views.wheels = false;
  Pipeline without(params);
  show(without, drive);
  EXPECT_EQ(count(without.map(), EdgeType::kWeak), 1);
}

/// K-28 in the pipeline: whatever comes, the neighbourhoods keep their bound and the map hangs together.
TEST(ViewMapper, ForgetsViewsOfFullNeighbourhoods) {
  PipelineParams params = stereoParams();
  params.views.train_after = 15;
  params.upkeep.upkeep = "lru_views";
  params.upkeep.max_views = 2;
  map::TopologicalMap bounded;
  int made = 0;
  for (int pass = 0; pass < 4; ++pass) {
    Pipeline mapper(params, std::move(bounded));
    for (const auto& report : show(mapper, blind(pass % 2 == 0 ? firstStereoDrive() : secondStereoDrive())))
      made += report.outcome == types::Outcome::kNewPlace;
    bounded = mapper.map();
    EXPECT_TRUE(isOnePart(bounded)) << pass;
  }
  EXPECT_LT(bounded.places().size(), static_cast<std::size_t>(made) / 2);
  const upkeep::NeighbourhoodParams near = params.upkeep.budget(30).near;
  for (const auto& [id, place] : bounded.places())
    EXPECT_LE(upkeep::neighbourhood(bounded, id, near).size(), 6u) << "views beside " << id.value;
  EXPECT_LT(worstPose(bounded), 0.3);
}

TEST(ViewMapper, TheLocalizerFindsViewsByTheirPoints) {
  const map::TopologicalMap& map = firstMap();
  Pipeline localizer(stereoParams(), map, Use::kFrozen);
  int accepted = 0, right = 0, asked = 0;
  const DriveFrames& drive = secondStereoDrive();
  for (std::size_t i = 0; i < drive.frames.size(); i += 4) {
    localizer.restart();
    const auto report = localizer.process(drive.frames[i]);
    ++asked;
    if (report.outcome != types::Outcome::kRecognised) continue;
    ++accepted;
    right +=
        (map.place(report.place).T_world_place->inverse() * drive.T_world_robot[i]).translation().norm() < 1;
  }
  EXPECT_EQ(right, accepted);
  EXPECT_GE(accepted, asked / 2);
}

/// Both eyes measure where a place is seen from; wheels that slip must not say otherwise where they did.
TEST(StereoPlaces, EdgesAreAsBothEyesMeasuredThem) {
  DriveFrames drive = firstStereoDrive();
  const Eigen::Isometry3d T_odom_start = *drive.frames.front().T_odom_robot;
  for (auto& frame : drive.frames) {
    Eigen::Isometry3d T_start_robot = T_odom_start.inverse() * *frame.T_odom_robot;
    T_start_robot.translation() *= 1.15;
    frame.T_odom_robot = T_start_robot;
  }
  PipelineParams params = stereoParams();
  params.mapping.nodes = "places";
  params.select.min_distance = 0.15;
  params.place.spacing = 0.5;
  Pipeline mapper(params);
  show(mapper, drive);
  mapper.finish();
  std::vector<double> errors, lengths;
  for (const auto& [id, e] : mapper.map().edges()) {
    errors.push_back(errorOf(mapper.map(), e.a, e.b, e.T_a_b.T_a_b));
    lengths.push_back(e.T_a_b.T_a_b.translation().norm());
  }
  ASSERT_GE(errors.size(), 5u);
  std::sort(errors.begin(), errors.end());
  std::sort(lengths.begin(), lengths.end());
  EXPECT_GT(lengths[lengths.size() / 2], 0.35);
  EXPECT_LT(errors[errors.size() / 2], 0.02) << "the wheels would be wrong by 5 cm";
}

TEST(ViewMapper, RefusesWhatDoesNotSuitStereoViews) {
  PipelineParams params = stereoParams();
  params.camera.stereo = false;
  EXPECT_THROW(Pipeline{params}, base::ConfigError);
  params = stereoParams();
  params.memory.memory = "fsh";
  EXPECT_THROW(Pipeline{params}, base::ConfigError);
  params = stereoParams();
  params.camera.file = ENGRAM_SOURCE_DIR "/share/cameras/omni_world.ini";
  EXPECT_THROW(Pipeline{params}, base::ConfigError);
}

TEST(ViewMapper, SaysWhatIsWrongWithAFrame) {
  Pipeline mapper(stereoParams());
  types::Frame frame = firstStereoDrive().frames[0];
  frame.right = cv::Mat();
  EXPECT_EQ(mapper.process(frame).reason, "the right image of the stereo camera is missing");
  frame.right = cv::Mat::zeros(100, 100, CV_8UC1);
  EXPECT_EQ(mapper.process(frame).outcome, types::Outcome::kUnusable);
}

}  // namespace
}  // namespace engram::pipeline

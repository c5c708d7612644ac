// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

#include "engram/base/error.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"
#include "engram/types/se3.h"
#include "stereo_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

namespace engram::pipeline::scans {
namespace {

using engram::testing::DriveFrames;
using engram::testing::firstStereoDrive;
using engram::testing::secondStereoDrive;
using map::EdgeType;

PipelineParams scanParams(const std::string& config = "visual_scans") {
  PipelineParams params;
  base::Config bound;
  params.bind(bound);
  bound.read(base::IniFile::load(ENGRAM_SOURCE_DIR "/config/" + config + ".ini"));
  params.camera.file = engram::testing::stereoParams().camera.file;
  params.stereo.min_inliers = 12;  // small images have less features
  params.views.sure_inliers = 25;
  return params;
}

struct Shown {
  std::vector<types::FrameReport> reports;
  int count(types::Outcome outcome) const {
    return static_cast<int>(
        std::count_if(reports.begin(), reports.end(), [&](const auto& r) { return r.outcome == outcome; }));
  }
};

/// Shows frames; a reference is surveyed where its own image was taken.
Shown show(Pipeline& mapper, const DriveFrames& drive, std::size_t from = 0, std::size_t to = 1000) {
  Shown shown;
  for (std::size_t i = from; i < std::min(to, drive.frames.size()); ++i) {
    shown.reports.push_back(mapper.process(drive.frames[i]));
    const auto& report = shown.reports.back();
    if (report.outcome == types::Outcome::kNewPlace)
      for (std::size_t k = 0; k <= i; ++k)
        if (drive.frames[k].stamp == mapper.map().place(report.place).createdStamp)
          mapper.survey(report.place, drive.T_world_robot[k]);
    mapper.map().checkInvariants();
  }
  return shown;
}

map::TopologicalMap mapOf(const DriveFrames& drive, const PipelineParams& params = scanParams()) {
  Pipeline mapper(params);
  show(mapper, drive);
  mapper.finish();
  return mapper.map();
}

/// The first drive by the filter; made once.
const map::TopologicalMap& firstMap() {
  static const map::TopologicalMap map = mapOf(firstStereoDrive());
  return map;
}

PipelineParams withGraph() {
  PipelineParams params = scanParams();
  params.posegraph.relaxer = "ceres";
  return params;
}

double errorOf(const map::TopologicalMap& map, base::PlaceId a, base::PlaceId b) {
  const Eigen::Isometry3d truth = map.place(a).T_world_place->inverse() * *map.place(b).T_world_place;
  const Eigen::Isometry3d ours = map.place(a).T_map_place.inverse() * map.place(b).T_map_place;
  return (truth.inverse() * ours).translation().norm();
}

/// Of the pose of every reference, seen from the first [m].
double worstPose(const map::TopologicalMap& map) {
  double worst = 0;
  for (const auto& [id, place] : map.places())
    worst = std::max(worst, errorOf(map, map.places().begin()->first, id));
  return worst;
}

/// How far the robot of a report is from the truth [m].
double errorOf(const map::TopologicalMap& map, const types::FrameReport& report,
               const Eigen::Isometry3d& T_world_robot) {
  const Eigen::Isometry3d& T_world_place = *map.place(report.pose->place).T_world_place;
  return ((T_world_place * report.pose->T_place_robot.T_a_b).inverse() * T_world_robot).translation().norm();
}

std::string dumpOf(const map::TopologicalMap& map) {
  std::ostringstream out;
  store::dump(out, {}, map.content(), {});
  return out.str();
}

int count(const map::TopologicalMap& map, EdgeType type) {
  int n = 0;
  for (const auto& [id, edge] : map.edges()) n += edge.type == type;
  return n;
}

/// V-08, V-09: few images become references, each one image late and by the pose that it had.
TEST(ScanMapper, AFewScansBecomeReferencesOneImageLate) {
  const DriveFrames& drive = firstStereoDrive();
  Pipeline mapper(scanParams());
  const Shown shown = show(mapper, drive);
  mapper.finish();
  const auto& map = mapper.map();
  ASSERT_GE(map.places().size(), 3u);
  EXPECT_LE(map.places().size(), 10u) << "of 60 images";
  EXPECT_EQ(shown.reports[0].reason, "the first scan");
  EXPECT_EQ(shown.reports[1].outcome, types::Outcome::kNewPlace);
  for (const auto& report : shown.reports) {
    if (report.outcome != types::Outcome::kNewPlace) continue;
    EXPECT_LT(map.place(report.place).createdStamp, report.stamp - 0.05);
  }
  EXPECT_GT(shown.count(types::Outcome::kRecognised), 20);
  EXPECT_LT(worstPose(map), 0.02 * drive.length());
  EXPECT_EQ(map.hopDistances(map.places().begin()->first, 1000).size(), map.places().size());
  for (const auto& [id, place] : map.places()) {
    EXPECT_GE(place.memory.features.size(), 12u);
    for (const float range : place.memory.features.ranges) EXPECT_GT(range, 0.0f);
  }
}

/// The paper's numbers: fewer points, and deviations that hold as well.
TEST(ScanMapper, TheRobotErrsAsItsCovarianceSays) {
  for (const char* config : {"visual_scans", "paper_scans"}) {
    const DriveFrames& drive = firstStereoDrive();
    Pipeline mapper(scanParams(config));
    double sum = 0;
    int n = 0;
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      const auto report = show(mapper, drive, i, i + 1).reports.front();
      if (!report.pose) continue;
      const Eigen::Isometry3d& T_world_place = *mapper.map().place(report.pose->place).T_world_place;
      const types::RelPose& found = report.pose->T_place_robot;
      const auto d = types::logSe3((T_world_place * found.T_a_b).inverse() * drive.T_world_robot[i]);
      const std::vector<int> plane{0, 1, 5};
      const Eigen::Vector3d e = d(plane);
      sum += e.dot(Eigen::Matrix3d(found.cov(plane, plane)).ldlt().solve(e));
      ++n;
    }
    ASSERT_GT(n, 25) << config;
    EXPECT_LT(sum / n, 6) << config << ": 3 is expected of a consistent filter";
    EXPECT_GT(sum / n, 0.5) << config;
  }
}

TEST(ScanMapper, SameFramesGiveTheSameMapWhateverTheThreads) {
  PipelineParams params = scanParams();
  params.recognise.threads = 3;
  EXPECT_EQ(dumpOf(firstMap()), dumpOf(mapOf(firstStereoDrive(), params)));
}

/// Poses and covariances survive a stop and a restart, to the last bit.
TEST(ScanMapper, GoesOnWithTheCovarianceThatTheMapKeeps) {
  const map::TopologicalMap& before = firstMap();
  for (const auto& [id, place] : before.places()) EXPECT_EQ(place.joint.with.size(), id.value + 1u);
  const std::string file = ::testing::TempDir() + "scans.engram";
  std::remove(file.c_str());
  map::TopologicalMap written = before;
  store::MapFile out = store::MapFile::create(file, Pipeline(scanParams()).header());
  out.commit(written, written.takeChanges());
  out.close();
  Pipeline again(scanParams(), store::MapFile::open(file, store::Access::kReadOnly).load());
  again.finish();
  for (const auto& [id, place] : before.places()) {
    EXPECT_EQ(again.map().place(id).joint.cov, place.joint.cov);
    EXPECT_EQ(again.map().place(id).T_map_place.matrix(), place.T_map_place.matrix());
  }
  const Shown shown = show(again, secondStereoDrive());
  again.finish();
  EXPECT_GT(shown.count(types::Outcome::kRecognised), 10);
  EXPECT_LT(worstPose(again.map()), 0.2);
  // What the map knew well before it knows at least as well now.
  for (const auto& [id, place] : before.places())
    EXPECT_LE(again.map().place(id).joint.own().trace(), place.joint.own().trace() * (1 + 1e-9));
}

/// V-12: the same scans under a graph; and the filter goes on where a graph left off.
TEST(ScanMapper, TheGraphIsTheOtherBackEnd) {
  const DriveFrames& drive = firstStereoDrive();
  map::TopologicalMap graph = mapOf(drive, withGraph());
  EXPECT_LT(worstPose(graph), 0.03 * drive.length());
  EXPECT_NEAR(static_cast<double>(graph.places().size()), static_cast<double>(firstMap().places().size()), 2);
  for (const auto& [id, place] : graph.places()) EXPECT_TRUE(place.joint.empty());
  Pipeline filter(scanParams(), std::move(graph));
  const Shown shown = show(filter, secondStereoDrive());
  filter.finish();
  EXPECT_GT(shown.count(types::Outcome::kRecognised), 10);
  EXPECT_LT(worstPose(filter.map()), 0.25);
  for (const auto& [id, place] : filter.map().places()) EXPECT_FALSE(place.joint.empty());
}

/// V-11, V-E7: a robot that was carried, its wheels standing still, is found by descriptors; the references
/// learn nothing of it.
TEST(ScanMapper, ACarriedRobotIsFoundAgain) {
  for (const PipelineParams& params : {scanParams(), withGraph()}) {
    DriveFrames drive = firstStereoDrive();
    Pipeline mapper(params);
    show(mapper, drive);
    mapper.finish();
    const auto before = mapper.map().places();
    const Eigen::Isometry3d T_odom_end = *drive.frames.back().T_odom_robot;
    const Eigen::Isometry3d T_start = *drive.frames[6].T_odom_robot;
    std::vector<types::FrameReport> reports;
    for (std::size_t i = 6; i < 24; ++i) {
      types::Frame frame = drive.frames[i];
      frame.stamp += 100;
      frame.T_odom_robot = T_odom_end * T_start.inverse() * *frame.T_odom_robot;
      reports.push_back(mapper.process(frame));
    }
    int found = 0;
    for (std::size_t k = 4; k < reports.size(); ++k) {
      if (reports[k].outcome != types::Outcome::kRecognised) continue;
      ++found;
      EXPECT_LT(errorOf(mapper.map(), reports[k], drive.T_world_robot[6 + k]), 0.15) << k;
    }
    EXPECT_GE(found, 3);
    for (const auto& [id, place] : before)
      EXPECT_LT((mapper.map().place(id).T_map_place.inverse() * place.T_map_place).translation().norm(),
                0.05);
  }
}

/// V-E8: where the chain breaks the wheels join the scans; without wheels a weak link does.
TEST(ScanMapper, ABrokenChainIsJoinedByTheWheelsOrByAWeakLink) {
  DriveFrames drive = firstStereoDrive();
  for (std::size_t i = 14; i < 40; ++i) {
    drive.frames[i].image = cv::Mat(drive.frames[i].image.size(), CV_8UC1, cv::Scalar::all(0));
    drive.frames[i].right = drive.frames[i].image;
  }
  Pipeline mapper(scanParams());
  const Shown shown = show(mapper, drive);
  mapper.finish();
  EXPECT_EQ(shown.count(types::Outcome::kUnusable), 26);
  EXPECT_EQ(count(mapper.map(), EdgeType::kWeak), 0);
  EXPECT_LT(worstPose(mapper.map()), 0.3);
}

TEST(ScanMapper, WorksWithoutWheels) {
  DriveFrames drive = firstStereoDrive();
  for (auto& frame : drive.frames) frame.T_odom_robot.reset();
  for (const PipelineParams& params : {scanParams(), withGraph()}) {
    const map::TopologicalMap map = mapOf(drive, params);
    EXPECT_GE(map.places().size(), 3u);
    EXPECT_LT(worstPose(map), 0.1 * drive.length()) << "nothing but matches: a weak one bends the map";
  }
}

TEST(ScanMapper, TheLocalizerFindsReferences) {
  Pipeline localizer(scanParams(), firstMap(), Use::kFrozen);
  const DriveFrames& drive = secondStereoDrive();
  int accepted = 0;
  for (std::size_t i = 0; i < drive.frames.size(); i += 4) {
    localizer.restart();
    const auto report = localizer.process(drive.frames[i]);
    if (report.outcome != types::Outcome::kRecognised) continue;
    ++accepted;
    EXPECT_LT(errorOf(firstMap(), report, drive.T_world_robot[i]), 0.5);
  }
  EXPECT_GE(accepted, 2);
}

TEST(ScanMapper, RefusesWhatDoesNotSuitScans) {
  PipelineParams params = scanParams();
  params.upkeep.upkeep = "lru_views";
  EXPECT_THROW(Pipeline{params}, base::ConfigError);
  params = scanParams();
  params.memory.memory = "fsh";
  EXPECT_THROW(Pipeline{params}, base::ConfigError);
  params = scanParams();
  params.mapping.nodes = "views";
  EXPECT_THROW(Pipeline{params}, base::ConfigError) << "ekf_scans needs scans";
}

}  // namespace
}  // namespace engram::pipeline::scans

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

#include "engram/base/error.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"
#include "engram/types/se3.h"
#include "tiny_drive.h"
#include "tiny_map.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace engram::pipeline {
namespace {

using engram::testing::firstDrive;
using engram::testing::firstMap;
using engram::testing::secondDrive;
using engram::testing::tinyParams;
using types::Outcome;

std::string dump(const map::MapContent& content) {
  std::ostringstream out;
  store::dump(out, {}, content, {});
  return out.str();
}

/// The place made nearest to where frame `index` of the second drive was taken.
base::PlaceId truePlace(std::uint64_t index) {
  const auto at = secondDrive().T_world_robot[static_cast<std::size_t>(index)].translation();
  base::PlaceId best;
  double least = 1e9;
  for (const auto& [id, place] : firstMap().places()) {
    const auto made = firstDrive().T_world_robot[static_cast<std::size_t>(place.createdIndex)].translation();
    if ((made - at).norm() < least) {
      least = (made - at).norm();
      best = id;
    }
  }
  return best;
}

std::vector<base::PlaceId> ascending(std::vector<base::PlaceId> ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

TEST(Localizer, AnswersAreRightAndTheFrozenMapStays) {
  const std::string before = dump(firstMap().content());
  Pipeline localizer(tinyParams(), firstMap(), Use::kFrozen);
  map::Cursor read = localizer.map().now();
  int accepted = 0, right = 0;
  for (const auto& frame : secondDrive().frames) {
    const types::FrameReport report = localizer.process(frame);
    EXPECT_TRUE(report.bestGuess.valid());
    if (report.outcome != Outcome::kRecognised) {
      EXPECT_EQ(report.outcome, Outcome::kRefused);
      EXPECT_FALSE(report.reason.empty());
      continue;
    }
    ++accepted;
    right += firstMap().hopDistances(truePlace(report.index), 1).count(report.place) > 0;
  }
  EXPECT_GE(accepted, static_cast<int>(secondDrive().frames.size()) * 7 / 10);
  EXPECT_GE(right, accepted * 95 / 100);
  EXPECT_EQ(dump(localizer.map().content()), before);
  EXPECT_TRUE(localizer.map().changesSince(read).empty());
}

/// Motion from where the report says that the robot is to where it is, by simulator ground truth: translation
/// [m], rotation vector [rad].
types::Vector6d poseError(const types::FrameReport& report) {
  const map::Place& place = firstMap().place(report.pose->place);
  const auto& T_world_place = firstDrive().T_world_robot[static_cast<std::size_t>(place.createdIndex)];
  return types::logSe3((T_world_place * report.pose->T_place_robot.T_a_b).inverse() *
                       secondDrive().T_world_robot[static_cast<std::size_t>(report.index)]);
}

/// One camera and wheels, in places that know how far their features are.
TEST(Localizer, PoseIsMetricAndKnowsHowGoodItIs) {
  Pipeline localizer(tinyParams(), firstMap(), Use::kFrozen);
  std::vector<double> distance, heading;
  double nees = 0;
  for (const auto& frame : secondDrive().frames) {
    const types::FrameReport report = localizer.process(frame);
    if (report.outcome != Outcome::kRecognised) continue;
    ASSERT_TRUE(report.pose);
    const types::Vector6d off = poseError(report);
    distance.push_back(off.head<2>().norm());
    heading.push_back(std::abs(off[5]));
    const Eigen::Vector3d flat(off[0], off[1], off[5]);
    const std::vector<int> plane{0, 1, 5};
    const Eigen::Matrix3d cov = report.pose->T_place_robot.cov(plane, plane);
    nees += flat.dot(cov.inverse() * flat) / 3;
  }
  const auto median = [](std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  ASSERT_GT(distance.size(), 20u);
  EXPECT_LT(median(distance), 0.08);
  EXPECT_LT(median(heading), 0.026);
  EXPECT_LT(*std::max_element(distance.begin(), distance.end()), 0.4);
  EXPECT_LT(nees / static_cast<double>(distance.size()), 3);
}

/// One image that contradicts odometry is doubted, two that agree are believed.
TEST(Localizer, ARobotThatWasCarriedFindsItself) {
  Pipeline localizer(tinyParams(), firstMap(), Use::kFrozen);
  auto frames = secondDrive().frames;
  const std::size_t carried = frames.size() / 2;
  for (std::size_t i = carried; i < frames.size(); ++i)
    frames[i].T_odom_robot = Eigen::Translation3d(1.5, -1, 0) * *frames[i].T_odom_robot;
  std::size_t lost = 0;
  double last = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const types::FrameReport report = localizer.process(frames[i]);
    if (!report.pose || i < carried) continue;
    last = poseError(report).head<2>().norm();
    lost += last > 0.5;
  }
  EXPECT_LE(lost, 6u);
  EXPECT_LT(last, 0.2);
}

TEST(Localizer, AdaptingChangesMemoriesAlone) {
  const auto withoutMemory = [](map::MapContent content) {
    for (auto& [id, place] : content.places) place.memory = {};
    content.redetections = {};
    for (auto& [id, edge] : content.edges) edge.correspondences.clear();  // they name remembered features
    return dump(content);
  };
  Pipeline localizer(tinyParams(), firstMap(), Use::kAdapting);
  map::Cursor read = localizer.map().now();
  std::size_t learnt = 0;
  base::PlaceId here;
  for (const auto& frame : secondDrive().frames) {
    const std::string before = dump(localizer.map().content());
    const types::FrameReport report = localizer.process(frame);
    const auto changes = localizer.map().changesSince(read);
    if (report.outcome == Outcome::kRecognised) here = report.place;
    EXPECT_EQ(changes.memories, ascending(report.learnt));
    if (report.learnt.empty()) {
      EXPECT_EQ(dump(localizer.map().content()), before);
      EXPECT_TRUE(changes.empty());
      continue;
    }
    learnt += report.learnt.size();
    EXPECT_GT(report.memory.rehearsed, 0);
    const auto near = localizer.map().hopDistances(here, tinyParams().recognise.learn_hops);
    for (const auto place : report.learnt) EXPECT_FALSE(near.count(place)) << place.value;
  }
  EXPECT_GT(learnt, 10u);
  const auto last = localizer.finish();
  EXPECT_THAT(last, ::testing::Not(::testing::IsEmpty()));
  EXPECT_EQ(localizer.map().changesSince(read).memories, ascending(last));
  EXPECT_GT(learnt + last.size(), 20u);
  EXPECT_TRUE(localizer.finish().empty()) << "what was learnt is not learnt again";
  EXPECT_EQ(withoutMemory(localizer.map().content()), withoutMemory(firstMap().content()));
  localizer.map().checkInvariants();
}

// A place that learnt at once would go on being the best match as the robot drives away.
TEST(Localizer, WhatIsSeenDoesNotDependOnWhatWasJustLearnt) {
  Pipeline frozen(tinyParams(), firstMap(), Use::kFrozen), adapting(tinyParams(), firstMap(), Use::kAdapting);
  int compared = 0;
  for (const auto& frame : secondDrive().frames) {
    const auto report = adapting.process(frame);
    if (!report.learnt.empty()) break;  // from here on they may differ
    const auto expected = frozen.process(frame);
    EXPECT_EQ(report.place, expected.place);
    EXPECT_EQ(report.bestGuessInterpolated, expected.bestGuessInterpolated);
    compared += report.outcome == Outcome::kRecognised;
  }
  EXPECT_GT(compared, tinyParams().recognise.learn_after);
}

// What an image looks like is learnt only after several answers in a row agree, so that a wrong one is not.
TEST(Localizer, LearnsNothingFromTheFirstAnswers) {
  Pipeline localizer(tinyParams(), firstMap(), Use::kAdapting);
  int accepted = 0;
  for (const auto& frame : secondDrive().frames) {
    accepted += localizer.process(frame).outcome == Outcome::kRecognised;
    if (accepted == tinyParams().recognise.learn_after - 1) break;
  }
  EXPECT_TRUE(localizer.finish().empty());
}

TEST(Localizer, StandingRobotLearnsOnce) {
  Pipeline localizer(tinyParams(), firstMap(), Use::kAdapting);
  types::Frame frame = secondDrive().frames[0];
  for (int i = 0; i < 5; ++i, frame.stamp += 1, ++frame.index)
    EXPECT_EQ(localizer.process(frame).outcome, Outcome::kRecognised);
  EXPECT_EQ(localizer.finish().size(), 1u);
}

// D-E3: once until another place was accepted.
TEST(Localizer, PerPassAPlaceLearnsOnceUntilItWasLeft) {
  auto params = tinyParams();
  params.memory.update_policy = "per_pass";
  params.select.min_distance = 0;  // so that a standing robot could learn again
  Pipeline localizer(params, firstMap(), Use::kAdapting);
  std::size_t learnt = 0, passed = 0, accepted = 0;
  base::PlaceId here;
  for (const auto& frame : secondDrive().frames) {
    const auto report = localizer.process(frame);
    learnt += report.learnt.size();
    if (report.outcome != Outcome::kRecognised) continue;
    ++accepted;
    passed += report.place != here;
    here = report.place;
  }
  learnt += localizer.finish().size();
  EXPECT_LT(passed, accepted) << "the drive must stay at some place for two images";
  EXPECT_LE(learnt, passed);
  EXPECT_GE(learnt + static_cast<std::size_t>(params.recognise.learn_after), passed);

  // A restart ends the pass: the place may learn again.
  types::Frame frame = secondDrive().frames.back();
  const auto stand = [&] {
    for (int i = 0; i < 5; ++i, ++frame.index) localizer.process(frame);
    return localizer.finish().size();
  };
  localizer.restart();
  EXPECT_EQ(stand(), 1u);
  EXPECT_EQ(stand(), 0u);
  localizer.restart();
  EXPECT_EQ(stand(), 1u);
}

// F-31, D-12: every view learnt is counted by the map, while it is mapped and while it adapts, and what is
// learnt from the counts changes what the places hold.
TEST(Localizer, LearntThresholdsReachTheMemories) {
  const auto adapted = [](const std::string& thresholds) {
    auto params = tinyParams();
    params.fsh.thresholds = thresholds;
    params.fsh.ltm_min_features = 50;
    Pipeline localizer(params, firstMap(), Use::kAdapting);
    std::uint64_t learnt = 0;
    for (const auto& frame : secondDrive().frames) learnt += localizer.process(frame).learnt.size();
    learnt += localizer.finish().size();
    const auto& seen = localizer.map().content().redetections;
    EXPECT_EQ(seen.views, firstMap().content().redetections.views + learnt);
    EXPECT_NE(memory::learntThreshold(seen, 0.7), 0.7);
    std::size_t longTerm = 0;
    for (const auto& [id, place] : localizer.map().places()) longTerm += place.memory.longTerm().size();
    return longTerm;
  };
  EXPECT_GT(firstMap().content().redetections.views, 10u);
  EXPECT_NE(adapted("learned"), adapted("fixed"));
}

TEST(Localizer, AdaptsWithEveryMemory) {
  for (const char* name : {"multi_store", "replace", "static"}) {
    auto params = tinyParams();
    params.memory.memory = name;
    Pipeline mapper(params);
    for (const auto& frame : firstDrive().frames) mapper.process(frame);
    Pipeline localizer(params, mapper.map(), Use::kAdapting);
    int accepted = 0, pruned = 0;
    for (const auto& frame : secondDrive().frames) {
      const auto report = localizer.process(frame);
      accepted += report.outcome == Outcome::kRecognised;
      pruned += report.memory.pruned;
    }
    localizer.finish();
    EXPECT_GE(accepted, static_cast<int>(secondDrive().frames.size()) / 2) << name;
    EXPECT_EQ(pruned > 0, std::string(name) != "static");
    localizer.map().checkInvariants();
  }
}

TEST(Localizer, ImagesInARowAreAcceptedWhereNoneHasMatchesEnough) {
  PipelineParams params = tinyParams();
  params.verify.min_inliers = 10000;  // geometry never confirms
  const std::string before = dump(firstMap().content());
  for (const int sequence : {0, 6}) {
    params.recognise.sequence = sequence;
    Pipeline localizer(params, firstMap(), Use::kAdapt);
    int accepted = 0, right = 0;
    for (const auto& frame : secondDrive().frames) {
      const types::FrameReport report = localizer.process(frame);
      if (report.outcome != Outcome::kRecognised) continue;
      EXPECT_EQ(report.acceptedBy, types::AcceptedBy::kSequence);
      EXPECT_GE(static_cast<int>(report.index), sequence - 1);
      ++accepted;
      right += firstMap().hopDistances(truePlace(report.index), 2).count(report.place) > 0;
    }
    localizer.finish();
    EXPECT_EQ(dump(localizer.map().content()), before) << "a sequence taught the map";
    if (sequence > 0) EXPECT_GE(accepted, 5);
    if (sequence == 0) EXPECT_EQ(accepted, 0);
    EXPECT_EQ(right, accepted);
  }
}

TEST(Localizer, RestartForgetsTheBelief) {
  Pipeline used(tinyParams(), firstMap(), Use::kFrozen);
  for (std::size_t i = 0; i < 10; ++i) used.process(secondDrive().frames[i]);
  Pipeline carriedOn(tinyParams(), firstMap(), Use::kFrozen);
  for (std::size_t i = 0; i < 10; ++i) carriedOn.process(secondDrive().frames[i]);
  const types::Frame& far = secondDrive().frames[28];
  Pipeline fresh(tinyParams(), firstMap(), Use::kFrozen);
  used.restart();
  const types::FrameReport a = used.process(far), b = fresh.process(far);
  ASSERT_EQ(a.hypotheses.size(), b.hypotheses.size());
  for (std::size_t k = 0; k < a.hypotheses.size(); ++k) {
    EXPECT_EQ(a.hypotheses[k].place, b.hypotheses[k].place);
    EXPECT_DOUBLE_EQ(a.hypotheses[k].posterior, b.hypotheses[k].posterior);
  }
  EXPECT_NE(carriedOn.process(far).hypotheses.front().posterior, a.hypotheses.front().posterior);
}

TEST(Localizer, UnusableImagesAreNoAnswers) {
  Pipeline localizer(tinyParams(), firstMap(), Use::kFrozen);
  EXPECT_EQ(localizer.process(secondDrive().frames[0]).outcome, Outcome::kRecognised);
  types::Frame frame = secondDrive().frames[1];
  frame.image = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0));
  EXPECT_EQ(localizer.process(frame).outcome, Outcome::kUnusable);
  frame.image = cv::Mat(100, 100, CV_8UC3, cv::Scalar::all(0));
  const types::FrameReport report = localizer.process(frame);
  EXPECT_EQ(report.outcome, Outcome::kUnusable);
  EXPECT_THAT(report.reason, ::testing::HasSubstr("100x100"));
  EXPECT_FALSE(report.place.valid());
  EXPECT_EQ(localizer.process(secondDrive().frames[3]).outcome, Outcome::kRecognised);
}

TEST(Localizer, EmptyMapIsAnError) { EXPECT_THROW(Pipeline(tinyParams(), {}, Use::kFrozen), base::Error); }

}  // namespace
}  // namespace engram::pipeline

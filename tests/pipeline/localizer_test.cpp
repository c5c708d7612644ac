// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/localizer.h"

#include "engram/base/error.h"
#include "engram/pipeline/mapper.h"
#include "engram/store/map_file.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>

#include <sstream>

namespace engram::pipeline {
namespace {

using engram::testing::firstDrive;
using engram::testing::secondDrive;
using engram::testing::tinyParams;
using types::Outcome;

std::string dump(const map::MapContent& content) {
  std::ostringstream out;
  store::dump(out, {}, content, {});
  return out.str();
}

const map::TopologicalMap& firstMap() {
  static const map::TopologicalMap map = [] {
    Mapper mapper(tinyParams());
    for (const auto& frame : firstDrive().frames) mapper.process(frame);
    mapper.finish();
    mapper.map().takeChanges();
    return mapper.map();
  }();
  return map;
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

TEST(Localizer, AnswersAreRightAndTheFrozenMapStays) {
  const std::string before = dump(firstMap().content());
  Localizer localizer(tinyParams(), firstMap());
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
  EXPECT_TRUE(localizer.map().takeChanges().empty());
}

TEST(Localizer, AdaptingChangesMemoriesAlone) {
  const auto withoutMemory = [](map::MapContent content) {
    for (auto& [id, place] : content.places) place.memory = {};
    for (auto& [id, edge] : content.edges) edge.correspondences.clear();  // they name remembered features
    return dump(content);
  };
  Localizer localizer(tinyParams(), firstMap(), true);
  int learnt = 0, accepted = 0;
  for (const auto& frame : secondDrive().frames) {
    const std::string before = dump(localizer.map().content());
    const types::FrameReport report = localizer.process(frame);
    const auto changes = localizer.map().takeChanges();
    accepted += report.outcome == Outcome::kRecognised;
    // Not before several answers in a row agree, so that a wrong one is not learnt.
    if (report.outcome != Outcome::kRecognised || accepted < tinyParams().recognise.learn_after ||
        changes.empty()) {
      EXPECT_EQ(dump(localizer.map().content()), before);
      EXPECT_TRUE(changes.empty());
      continue;
    }
    ++learnt;
    EXPECT_THAT(changes.memories, ::testing::ElementsAre(report.place));
    EXPECT_GT(report.memory.rehearsed, 0);
  }
  EXPECT_GT(learnt, 20);
  EXPECT_EQ(withoutMemory(localizer.map().content()), withoutMemory(firstMap().content()));
  localizer.map().checkInvariants();
}

TEST(Localizer, StandingRobotLearnsOnce) {
  Localizer localizer(tinyParams(), firstMap(), true);
  types::Frame frame = secondDrive().frames[0];
  int learnt = 0;
  for (int i = 0; i < 5; ++i, frame.stamp += 1, ++frame.index) {
    EXPECT_EQ(localizer.process(frame).outcome, Outcome::kRecognised);
    learnt += !localizer.map().takeChanges().empty();
  }
  EXPECT_EQ(learnt, 1);
}

// D-E3: once until another place was accepted.
TEST(Localizer, PerPassAPlaceLearnsOnceUntilItWasLeft) {
  auto params = tinyParams();
  params.memory.update_policy = "per_pass";
  params.select.min_distance = 0;  // so that a standing robot could learn again
  Localizer localizer(params, firstMap(), true);
  base::PlaceId here;
  bool hasLearnt = false;
  int learnt = 0, passed = 0, accepted = 0;
  for (const auto& frame : secondDrive().frames) {
    const auto report = localizer.process(frame);
    const bool changed = !localizer.map().takeChanges().empty();
    if (report.outcome != Outcome::kRecognised) continue;
    ++accepted;
    if (report.place != here) {
      ++passed;
      hasLearnt = false;
    }
    here = report.place;
    EXPECT_FALSE(changed && hasLearnt) << "image " << report.index;
    hasLearnt |= changed;
    learnt += changed;
  }
  EXPECT_LT(passed, accepted) << "the drive must stay at some place for two images";
  EXPECT_GE(learnt, passed - params.recognise.learn_after);

  // A restart ends the pass: the place may learn again.
  types::Frame frame = secondDrive().frames.back();
  const auto learnsStanding = [&] {
    int times = 0;
    for (int i = 0; i < 5; ++i, ++frame.index) {
      localizer.process(frame);
      times += !localizer.map().takeChanges().empty();
    }
    return times;
  };
  localizer.restart();
  EXPECT_EQ(learnsStanding(), 1);
  EXPECT_EQ(learnsStanding(), 0);
  localizer.restart();
  EXPECT_EQ(learnsStanding(), 1);
}

TEST(Localizer, AdaptsWithEveryMemory) {
  for (const char* name : {"multi_store", "replace", "static"}) {
    auto params = tinyParams();
    params.memory.memory = name;
    Mapper mapper(params);
    for (const auto& frame : firstDrive().frames) mapper.process(frame);
    Localizer localizer(params, mapper.map(), true);
    int accepted = 0, pruned = 0;
    for (const auto& frame : secondDrive().frames) {
      const auto report = localizer.process(frame);
      accepted += report.outcome == Outcome::kRecognised;
      pruned += report.memory.pruned;
    }
    EXPECT_GE(accepted, static_cast<int>(secondDrive().frames.size()) / 2) << name;
    EXPECT_EQ(pruned > 0, std::string(name) != "static");
    localizer.map().checkInvariants();
  }
}

TEST(Localizer, RestartForgetsTheBelief) {
  Localizer used(tinyParams(), firstMap());
  for (std::size_t i = 0; i < 10; ++i) used.process(secondDrive().frames[i]);
  Localizer carriedOn(tinyParams(), firstMap());
  for (std::size_t i = 0; i < 10; ++i) carriedOn.process(secondDrive().frames[i]);
  const types::Frame& far = secondDrive().frames[28];
  Localizer fresh(tinyParams(), firstMap());
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
  Localizer localizer(tinyParams(), firstMap());
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

TEST(Localizer, EmptyMapIsAnError) { EXPECT_THROW(Localizer(tinyParams(), {}), base::Error); }

}  // namespace
}  // namespace engram::pipeline

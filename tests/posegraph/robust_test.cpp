// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/posegraph/robust.h"

#include "big_graphs.h"

#include <gtest/gtest.h>

namespace engram::posegraph {
namespace {

struct Count {
  std::size_t trueIn = 0, trueOut = 0, falseIn = 0, falseOut = 0;
};

Count count(const Drive& drive, const std::vector<ClosureDecision>& decisions) {
  Count c;
  for (std::size_t i = 0; i < decisions.size(); ++i) {
    if (drive.isTrue[i])
      ++(decisions[i].accepted ? c.trueIn : c.trueOut);
    else
      ++(decisions[i].accepted ? c.falseIn : c.falseOut);
  }
  return c;
}

class Lies : public ::testing::TestWithParam<Drive (*)(std::uint64_t)> {};

Drive smallStreets(std::uint64_t seed) { return manhattan(500, seed); }
Drive smallCorridor(std::uint64_t seed) { return corridor(500, seed); }
Drive smallBuildings(std::uint64_t seed) { return buildings(500, seed); }

/// True closures alone: nearly all are believed, and the map is as good as the plain optimum.
TEST_P(Lies, TruthIsBelieved) {
  const Drive drive = GetParam()(11);
  const auto r = relaxRobustly({}, drive.trusted, drive.closures);
  const Count c = count(drive, r.decisions);
  EXPECT_GE(static_cast<double>(c.trueIn), 0.97 * static_cast<double>(c.trueIn + c.trueOut));
  Graph all = drive.trusted;
  all.constraints.insert(all.constraints.end(), drive.closures.begin(), drive.closures.end());
  RelaxerParams exact;
  exact.max_iterations = 200;
  const double optimum = ate(drive.truth, makeRelaxer(exact)->relax(all).poses);
  EXPECT_LT(ate(drive.truth, r.relaxation.poses), 1.2 * optimum + 0.02);
}

TEST_P(Lies, TenPercentChangeNothing) {
  for (const bool clustered : {false, true}) {
    Drive drive = GetParam()(12);
    const double clean = ate(drive.truth, relaxRobustly({}, drive.trusted, drive.closures).relaxation.poses);
    addLies(drive, 0.1, clustered, 5);
    const auto r = relaxRobustly({}, drive.trusted, drive.closures);
    EXPECT_LT(ate(drive.truth, r.relaxation.poses), 1.2 * clean) << "clustered " << clustered;
    EXPECT_EQ(count(drive, r.decisions).falseIn, 0u);
  }
}

TEST_P(Lies, HalfDoesNotBreakTheMap) {
  for (const bool clustered : {false, true}) {
    Drive drive = GetParam()(13);
    const double clean = ate(drive.truth, relaxRobustly({}, drive.trusted, drive.closures).relaxation.poses);
    addLies(drive, 0.5, clustered, 6);
    const auto r = relaxRobustly({}, drive.trusted, drive.closures);
    EXPECT_LT(ate(drive.truth, r.relaxation.poses), 2 * clean + 0.1) << "clustered " << clustered;
    const Count c = count(drive, r.decisions);
    EXPECT_GT(c.trueIn, 10 * c.falseIn);
  }
}

INSTANTIATE_TEST_SUITE_P(Drives, Lies, ::testing::Values(&smallStreets, &smallCorridor, &smallBuildings));

/// The map was bent by an alias that was believed while nothing spoke against it; with the laps that follow
/// it leaves, and the map is straight again.
TEST(Robust, LaterEvidenceRemovesAnAlias) {
  const Drive drive = corridor(400, 4, 4);
  Drive lies = drive;
  addLies(lies, 0.15, true, 8);
  Graph bent = drive.trusted;
  std::vector<ClosureDecision> believed(lies.closures.size());
  for (std::size_t i = 0; i < lies.closures.size(); ++i) {
    if (lies.isTrue[i]) continue;
    bent.constraints.push_back(lies.closures[i]);
    bent.constraints.back().robust = false;
    believed[i].accepted = true;
  }
  bent.poses = makeRelaxer({})->relax(bent).poses;
  ASSERT_GT(ate(drive.truth, bent.poses), 2.0);
  bent.constraints = drive.trusted.constraints;
  for (const bool remembered : {false, true}) {
    const auto later =
        relaxRobustly({}, bent, lies.closures, remembered ? believed : std::vector<ClosureDecision>{});
    EXPECT_EQ(count(lies, later.decisions).falseIn, 0u);
    EXPECT_LT(ate(lies.truth, later.relaxation.poses), 0.5);
  }
}

/// Corridors that look alike give runs of matches that odometry itself denies. However many they are, they
/// must not outvote a closure that it does not deny.
TEST(Robust, WhatOdometryDeniesHasNoVote) {
  const Drive all = corridor(200, 2, 3);
  Drive drive = all;
  const std::size_t last = all.closures.size() - 1;
  drive.closures = {all.closures[last - 1], all.closures[last]};
  drive.isTrue = {true, true};
  for (std::uint32_t i = 0; i < 12; ++i) {  // places 15 m apart are taken for one, each as the one before
    Constraint lie = all.closures[last];
    lie.a = base::PlaceId(drive.closures[0].a.value - 40 + i);
    lie.b = base::PlaceId(lie.a.value - 15);
    drive.closures.push_back(lie);
    drive.isTrue.push_back(false);
  }
  const auto result = relaxRobustly({}, drive.trusted, drive.closures);
  EXPECT_EQ(count(drive, result.decisions).falseIn, 0u);
  EXPECT_NE(result.decisions[0].reason, ClosureReason::kOutvoted);
  EXPECT_NE(result.decisions[1].reason, ClosureReason::kOutvoted);
}

/// Closures as they come, each call with the decisions of the last: the same map as with all at once.
TEST(Robust, OneByOneIsAsGoodAsAllAtOnce) {
  Drive drive = corridor(300, 6, 3);
  addLies(drive, 0.2, true, 4);
  std::vector<std::size_t> order(drive.closures.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](auto i, auto j) { return drive.closures[i].a < drive.closures[j].a; });
  Graph graph = drive.trusted;
  std::vector<Constraint> known;
  RobustRelaxation r;
  for (const std::size_t i : order) {
    known.push_back(drive.closures[i]);
    r = relaxRobustly({}, graph, known, r.decisions);
    graph.poses = r.relaxation.poses;
  }
  const auto all = relaxRobustly({}, drive.trusted, drive.closures);
  EXPECT_LT(ate(drive.truth, r.relaxation.poses), 1.2 * ate(drive.truth, all.relaxation.poses) + 0.01);
  for (std::size_t k = 0; k < order.size(); ++k) {
    EXPECT_TRUE(drive.isTrue[order[k]] || !r.decisions[k].accepted) << k;
  }
}

TEST(Robust, RefusedClosureReturnsWhenOthersAgree) {
  const Drive drive = corridor(600, 4, 2);
  // The first that closes the whole lap, alone: the estimate is vague by then.
  std::vector<Constraint> lone{drive.closures.front()};
  RelaxerParams params;
  params.gate.gate_lone_sigma = 0.5;
  const auto before = relaxRobustly(params, drive.trusted, lone);
  EXPECT_FALSE(before.decisions[0].accepted);
  EXPECT_EQ(before.decisions[0].reason, ClosureReason::kUnsupported);
  const auto after = relaxRobustly(params, drive.trusted, drive.closures);
  EXPECT_TRUE(after.decisions[0].accepted);
  EXPECT_EQ(after.decisions[0].reason, ClosureReason::kAgrees);
}

TEST(Robust, ReviewRemovesWhatTheGraphDeniesAndRestoresWhatAgrees) {
  Drive drive = corridor(400, 7, 4);
  addLies(drive, 0.02, false, 3);
  const auto r = relaxRobustly({}, drive.trusted, drive.closures);
  Graph graph = drive.trusted;
  graph.poses = r.relaxation.poses;
  // A lie declared true, and a truth declared false, over a good estimate.
  auto decisions = r.decisions;
  const auto lie =
      static_cast<std::size_t>(std::find(drive.isTrue.begin(), drive.isTrue.end(), 0) - drive.isTrue.begin());
  ASSERT_LT(lie, decisions.size());
  decisions[lie].accepted = true;
  decisions[0].accepted = false;
  const auto after = reviewClosures(graph, drive.closures, decisions, {});
  EXPECT_FALSE(after[lie].accepted);
  EXPECT_EQ(after[lie].reason, ClosureReason::kContradicted);
  EXPECT_GT(after[lie].chi2, 100);
  EXPECT_TRUE(after[0].accepted);
}

TEST(Robust, SameInputSameOutputAndOddInput) {
  Drive drive = corridor(300, 5, 3);
  addLies(drive, 0.3, true, 2);
  const auto a = relaxRobustly({}, drive.trusted, drive.closures),
             b = relaxRobustly({}, drive.trusted, drive.closures);
  for (const auto& [id, T] : a.relaxation.poses) EXPECT_EQ(T.matrix(), b.relaxation.poses.at(id).matrix());
  const auto none = relaxRobustly({}, drive.trusted, {});
  EXPECT_TRUE(none.decisions.empty());
  EXPECT_EQ(none.relaxation.poses.size(), drive.trusted.poses.size());
  const std::vector<Constraint> bad{constraint(2, 9999, planarPose(0, 0, 0), isotropic(0.1, 0.1), true)};
  EXPECT_EQ(relaxRobustly({}, drive.trusted, bad).decisions[0].reason, ClosureReason::kUnusable);
}

}  // namespace
}  // namespace engram::posegraph

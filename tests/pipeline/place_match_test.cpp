// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/place_match.h"

#include "engram/memory/models.h"
#include "engram/pipeline/perception.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace engram::pipeline {
namespace {

using engram::testing::firstDrive;

types::Features featuresOf(std::size_t frame) {
  static Perception perception(engram::testing::tinyParams().camera, {});
  const cv::Mat& image = firstDrive().frames[frame].image;
  EXPECT_TRUE(perception.refusal(image).empty());
  return perception(image);
}

memory::PlaceMemory memoryOf(const types::Features& view) {
  return memory::makeMemoryModel({}, {}, {})->start(view);
}

TEST(Similarity, IsTheClosedFormOfEquation8) {
  EXPECT_DOUBLE_EQ(similarity(25, 100), 0.5);
  EXPECT_DOUBLE_EQ(similarity(9, 400), 0.15);
  EXPECT_DOUBLE_EQ(similarity(100, 100), 1.0);
  EXPECT_DOUBLE_EQ(similarity(120, 100), 1.0);  // several matches of one feature are no more than all
  EXPECT_DOUBLE_EQ(similarity(0, 100), 0.0);
  EXPECT_DOUBLE_EQ(similarity(10, 0), 0.0);
  for (int m = 1; m < 50; ++m) EXPECT_GT(similarity(m + 1, 50), similarity(m, 50));
}

TEST(StrongEnough, NeedsGeometryInliersAndSimilarity) {
  RecogniseParams params;
  params.accept_inliers = 20;
  params.accept_similarity = 0.2;
  PlaceMatch match;
  match.reason = geometry::Reason::kOk;
  match.matches.resize(20);
  match.similarity = 0.2;
  EXPECT_TRUE(strongEnough(match, params));
  PlaceMatch other = match;
  other.reason = geometry::Reason::kAccidental;
  EXPECT_FALSE(strongEnough(other, params));
  other = match;
  other.matches.resize(19);
  EXPECT_FALSE(strongEnough(other, params));
  other = match;
  other.similarity = 0.199;
  EXPECT_FALSE(strongEnough(other, params));
}

TEST(InPlaceFrame, TurnsBearingsAndNothingElse) {
  const types::Features view = featuresOf(0);
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  const types::Features turned = inPlaceFrame(view, R);
  ASSERT_EQ(turned.size(), view.size());
  EXPECT_EQ(turned.descriptors, view.descriptors);
  for (std::size_t i = 0; i < view.size(); ++i) {
    EXPECT_LT((turned.bearings[i].cast<double>() - R * view.bearings[i].cast<double>()).norm(), 1e-6);
    EXPECT_NEAR(turned.bearings[i].norm(), 1.0f, 1e-6f);
  }
}

TEST(MatchToPlace, ViewAgainstItselfMatchesWhollyWithoutMotion) {
  const types::Features view = featuresOf(0);
  const memory::PlaceMemory place = memoryOf(view);
  const PlaceMatch match = matchToPlace(view, place, {}, {});
  ASSERT_TRUE(match.verified());
  EXPECT_GT(match.matches.size(), place.features.size() * 9 / 10);
  for (const auto& m : match.matches)
    EXPECT_LT((view.bearings[static_cast<std::size_t>(m.a)] -
               place.features.bearings[static_cast<std::size_t>(m.b)])
                  .norm(),
              0.02);
  EXPECT_TRUE(match.R_place_view.isApprox(Eigen::Matrix3d::Identity(), 1e-3));
  EXPECT_GT(match.similarity, 0.9);
}

TEST(MatchToPlace, FindsTheTrueRelativePoseOfTheNextImage) {
  for (const std::size_t i : {0u, 6u, 13u, 27u}) {
    const PlaceMatch match = matchToPlace(featuresOf(i + 1), memoryOf(featuresOf(i)), {}, {});
    ASSERT_TRUE(match.verified()) << i;
    const auto& poses = firstDrive().T_world_robot;
    const Eigen::Isometry3d truth = poses[i].inverse() * poses[i + 1];
    const double turn = Eigen::AngleAxisd(truth.linear().transpose() * match.R_place_view).angle();
    EXPECT_LT(turn, 0.05) << i;
    const double along = match.direction_place.dot(truth.translation().normalized());
    EXPECT_GT(along, std::cos(0.2)) << i;
  }
}

TEST(MatchToPlace, SimilarityCountsLongTermFeaturesAlone) {
  const types::Features view = featuresOf(0);
  memory::PlaceMemory place = memoryOf(view);
  const PlaceMatch before = matchToPlace(view, place, {}, {});
  int forgotten = 0;
  std::set<int> shortTerm;
  for (std::size_t i = 0; i < place.states.size(); i += 2) {
    forgotten += place.states[i].stage == memory::Stage::kLongTerm;
    place.states[i].stage = memory::Stage::kShortTerm;
  }
  ASSERT_GT(forgotten, 10);
  const PlaceMatch after = matchToPlace(view, place, {}, {});
  EXPECT_EQ(after.matches.size(), before.matches.size());  // short-term features take part
  EXPECT_LT(after.longTermInliers, before.longTermInliers);
  const auto isLongTerm = [&](const types::Match& m) {
    return place.states[static_cast<std::size_t>(m.b)].stage == memory::Stage::kLongTerm;
  };
  const auto counted = std::count_if(after.matches.begin(), after.matches.end(), isLongTerm);
  EXPECT_EQ(after.longTermInliers, counted);
  EXPECT_DOUBLE_EQ(after.similarity,
                   std::sqrt(static_cast<double>(counted) / static_cast<double>(place.longTerm().size())));
}

TEST(MatchToPlace, UnrelatedViewsAreRefused) {
  // Opposite sides of the loop: other walls, other rooms.
  for (const auto& [a, b] : {std::pair{2u, 22u}, {5u, 25u}, {8u, 28u}, {12u, 31u}}) {
    const PlaceMatch match = matchToPlace(featuresOf(a), memoryOf(featuresOf(b)), {}, {});
    EXPECT_FALSE(strongEnough(match, {})) << a << " and " << b << ": " << match.matches.size();
  }
}

TEST(MatchToPlace, NothingAgainstNothing) {
  const types::Features view = featuresOf(0);
  types::Features none;
  none.descriptors = types::Descriptors(view.descriptors.kind(), view.descriptors.dim());
  const PlaceMatch match = matchToPlace(none, memoryOf(view), {}, {});
  EXPECT_FALSE(match.verified());
  EXPECT_EQ(match.tentative, 0);
  EXPECT_EQ(match.similarity, 0.0);
}

}  // namespace
}  // namespace engram::pipeline

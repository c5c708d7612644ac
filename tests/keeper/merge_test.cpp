// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/merge.h"

#include "engram/base/error.h"
#include "engram/keeper/diff.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"
#include "keeper_maps.h"
#include "tiny_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

namespace engram::keeper {
namespace {

using engram::testing::DriveFrames;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A map that a robot of its own made of a part of a drive, every place surveyed.
store::WholeMap mapOf(const DriveFrames& drive, double from, double to, std::uint32_t fingerprint) {
  const auto n = static_cast<double>(drive.frames.size());
  pipeline::PipelineParams params = engram::testing::tinyParams();
  pipeline::Pipeline mapper(params);
  store::WholeMap whole;
  for (auto i = static_cast<std::size_t>(from * n); i < static_cast<std::size_t>(to * n); ++i) {
    const types::FrameReport report = mapper.process(drive.frames[i]);
    if (report.outcome == types::Outcome::kNewPlace) mapper.survey(report.place, drive.T_world_robot[i]);
    whole.records.push_back(report);
  }
  mapper.finish();
  whole.header = mapper.header();
  base::Config config;
  params.bind(config);
  whole.header.parameters = config.dump();
  whole.content = mapper.map().content();
  store::Drive made{.session = 0, .source = "part", .fingerprint = fingerprint, .firstStamp = from};
  made.images = whole.records.size();
  made.finished = true;
  whole.drives.push_back(made);
  return whole;
}

const store::WholeMap& first() {
  static const store::WholeMap map = mapOf(engram::testing::firstDrive(), 0, 1, 1);
  return map;
}
const store::WholeMap& second() {
  static const store::WholeMap map = mapOf(engram::testing::secondDrive(), 0, 1, 2);
  return map;
}

/// Root mean square distance of places from the truth, once both are laid over each other in the plane [m].
double errorOf(const map::MapContent& content) {
  std::vector<Eigen::Vector2d> ours, truth;
  Eigen::Vector2d meanOurs = Eigen::Vector2d::Zero(), meanTruth = Eigen::Vector2d::Zero();
  const auto n = static_cast<double>(content.places.size());
  for (const auto& [id, place] : content.places) {
    ours.emplace_back(place.T_map_place(0, 3), place.T_map_place(1, 3));
    truth.emplace_back((*place.T_world_place)(0, 3), (*place.T_world_place)(1, 3));
    meanOurs += ours.back() / n;
    meanTruth += truth.back() / n;
  }
  double along = 0, across = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const Eigen::Vector2d p = ours[i] - meanOurs, q = truth[i] - meanTruth;
    along += p.dot(q);
    across += p.x() * q.y() - p.y() * q.x();
  }
  const Eigen::Rotation2Dd turn(std::atan2(across, along));
  double squares = 0;
  for (std::size_t i = 0; i < ours.size(); ++i)
    squares += (turn * Eigen::Vector2d(ours[i] - meanOurs) - (truth[i] - meanTruth)).squaredNorm();
  return std::sqrt(squares / n);
}

store::WholeMap joined(store::WholeMap a, const store::WholeMap& b, Merged* result = nullptr) {
  const Merged merged = merge(a, b, "a", "b");
  EXPECT_TRUE(merged.joined) << merged.reason;
  if (result != nullptr) *result = merged;
  return a;
}

double totalVotes(const map::MapContent& content) {
  double sum = 0;
  for (const auto& [id, place] : content.places)
    for (const auto& state : place.memory->states) sum += static_cast<double>(state.value);
  return sum;
}

void expectSound(const store::WholeMap& map) {
  EXPECT_EQ(map::brokenRules(map.content), std::vector<std::string>{});
  EXPECT_EQ(engram::testing::parts(map.content), 1u);
  std::set<int> sessions;
  for (const auto& point : map.content.path) sessions.insert(point.session);
  EXPECT_EQ(sessions.size(), map.drives.size());
  std::uint64_t images = 0;
  for (const store::Drive& drive : map.drives) {
    EXPECT_EQ(drive.firstRecord, images);
    EXPECT_TRUE(sessions.contains(drive.session));
    images += drive.images;
  }
  EXPECT_EQ(images, map.records.size());
  for (const auto& r : map.records) EXPECT_TRUE(!r.place.valid() || map.content.places.contains(r.place));
}

TEST(Merge, AMapMergedWithItselfIsItself) {
  const store::WholeMap merged = joined(first(), first());
  EXPECT_TRUE(diff(merged, first()).same());
}

TEST(Merge, TwoMapsOfOneBuildingMadeApartBecomeOne) {
  Merged result;
  const store::WholeMap merged = joined(first(), second(), &result);
  expectSound(merged);
  EXPECT_GT(result.united, second().content.places.size() / 3);
  EXPECT_EQ(merged.content.places.size(),
            first().content.places.size() + second().content.places.size() - result.united);
  // Each place is where it was, as well as in its own map.
  const double apart = std::max(errorOf(first().content), errorOf(second().content));
  EXPECT_LT(errorOf(merged.content), 1.5 * apart + 0.02);
}

TEST(Merge, MergingTheSecondMapAgainChangesNothing) {
  const store::WholeMap once = joined(first(), second());
  EXPECT_TRUE(diff(joined(once, second()), once).same());
  EXPECT_TRUE(diff(joined(second(), once), once).same());
}

TEST(Merge, TheOrderDoesNotMatter) {
  Merged ab, ba;
  const store::WholeMap x = joined(first(), second(), &ab), y = joined(second(), first(), &ba);
  EXPECT_NEAR(static_cast<double>(x.content.places.size()), static_cast<double>(y.content.places.size()),
              0.1 * static_cast<double>(x.content.places.size()));
  EXPECT_NEAR(totalVotes(x.content), totalVotes(y.content), 0.05 * totalVotes(x.content));
  expectSound(y);
}

TEST(Merge, NorDoesTheGrouping) {
  const store::WholeMap c = mapOf(engram::testing::secondDrive(), 0.5, 1, 3);
  const store::WholeMap b = mapOf(engram::testing::secondDrive(), 0, 0.6, 4);
  const store::WholeMap left = joined(joined(first(), b), c), right = joined(first(), joined(b, c));
  EXPECT_NEAR(static_cast<double>(left.content.places.size()),
              static_cast<double>(right.content.places.size()),
              0.1 * static_cast<double>(left.content.places.size()));
  EXPECT_NEAR(errorOf(left.content), errorOf(right.content), 0.05);
  EXPECT_NEAR(totalVotes(left.content), totalVotes(right.content), 0.05 * totalVotes(left.content));
  EXPECT_EQ(left.drives.size(), 3u);
  expectSound(left);
  expectSound(right);
}

TEST(Merge, CopiesThatWentOnApartShareTheirPast) {
  store::WholeMap mine = first(), theirs = first();
  const map::PlaceId learnt(2);
  mine.content.places.at(map::PlaceId(1)).memory.edit().updates += 3;
  mine.drives.push_back(
      {.id = 1, .session = -1, .source = "mine", .fingerprint = 8, .firstRecord = mine.records.size()});
  theirs.content.places.at(learnt).memory.edit().states[0].value += 5;
  theirs.content.places.at(learnt).memory.edit().updates += 5;
  store::Drive more{.id = 1, .session = -1, .source = "taught", .fingerprint = 9};
  more.firstRecord = theirs.records.size();
  theirs.drives.push_back(more);
  Merged result;
  const store::WholeMap merged = joined(mine, theirs, &result);
  EXPECT_EQ(result.known, first().content.places.size());
  EXPECT_EQ(merged.content.places.size(), first().content.places.size());
  EXPECT_EQ(merged.content.edges.size(), first().content.edges.size());
  EXPECT_EQ(merged.content.path.size(), first().content.path.size());
  EXPECT_EQ(merged.content.places.at(learnt).memory->updates,
            theirs.content.places.at(learnt).memory->updates);
  EXPECT_EQ(merged.content.places.at(map::PlaceId(1)).memory->updates,
            mine.content.places.at(map::PlaceId(1)).memory->updates);
  EXPECT_EQ(merged.drives.size(), 3u);
}

TEST(Merge, TwoBuildingsAreKeptApart) {
  // The places of the first map with their memories dealt out anew: every one is recognised, and they do not
  // agree on where the building lies.
  store::WholeMap other = first();
  std::vector<map::PlaceId> ids;
  for (const auto& [id, place] : other.content.places) ids.push_back(id);
  std::vector<std::size_t> deal(ids.size());
  std::iota(deal.begin(), deal.end(), 0u);
  base::Rng rng(3);
  for (std::size_t i = deal.size(); i > 1; --i) std::swap(deal[i - 1], deal[rng.below(i)]);
  for (std::size_t i = 0; i < ids.size(); ++i)
    other.content.places.at(ids[i]).memory = first().content.places.at(ids[deal[i]]).memory;
  for (auto& [id, edge] : other.content.edges) edge.correspondences.clear();
  other.drives[0].fingerprint = 77;
  store::WholeMap a = first();
  const Merged alike = merge(a, other, "a", "b");
  EXPECT_FALSE(alike.joined);
  EXPECT_THAT(alike.reason, HasSubstr("agree"));
  EXPECT_TRUE(diff(a, first()).same());
  // One of the same plan: a part of it looks the same, at the same spots.
  store::WholeMap twin = first();
  for (auto& [id, place] : twin.content.places)
    if (id.value % 5 != 0) place.memory = engram::testing::randomMemory(rng, 200, 1);
  for (auto& [id, edge] : twin.content.edges) edge.correspondences.clear();
  twin.drives[0].fingerprint = 79;
  const Merged plan = merge(a, twin, "a", "b");
  EXPECT_FALSE(plan.joined);
  EXPECT_GE(plan.agreeing, 3u);
  EXPECT_THAT(plan.reason, HasSubstr("one plan"));
  // One whose places show nothing that is known here.
  store::WholeMap strange = first();
  for (auto& [id, place] : strange.content.places) place.memory = engram::testing::randomMemory(rng, 200, 1);
  for (auto& [id, edge] : strange.content.edges) edge.correspondences.clear();
  strange.drives[0].fingerprint = 78;
  const Merged none = merge(a, strange, "a", "b");
  EXPECT_FALSE(none.joined);
  EXPECT_THAT(none.reason, HasSubstr("no place"));
}

TEST(Merge, WhatCannotBeHeldAgainstEachOtherIsRefused) {
  store::WholeMap a = first(), b = second();
  b.header.extractor = "akaze";
  EXPECT_THAT([&] { merge(a, b, "a", "b"); }, ThrowsMessage<base::ConfigError>(HasSubstr("extractor")));
}

}  // namespace
}  // namespace engram::keeper

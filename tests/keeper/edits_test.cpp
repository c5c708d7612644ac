// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/edits.h"

#include "engram/base/error.h"
#include "engram/keeper/closures.h"
#include "keeper_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram::keeper {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// All numbers that records and drives share fit each other.
void expectInStep(const store::WholeMap& map) {
  std::uint64_t next = map.firstRecord;
  for (std::size_t i = 0; i < map.drives.size(); ++i) {
    EXPECT_EQ(map.drives[i].id, i);
    EXPECT_EQ(map.drives[i].firstRecord, next);
    next += map.drives[i].images;
  }
  EXPECT_EQ(next, map.firstRecord + map.records.size());
  for (const auto& r : map.records) EXPECT_TRUE(!r.place.valid() || map.content.places.contains(r.place));
}

TEST(Reduce, ComesToTheTargetAndKeepsTheGraphTogether) {
  for (const std::size_t target : {30u, 20u, 7u, 2u}) {
    store::WholeMap map = testing::twoDrives(24, 2);
    const std::size_t before = map.content.places.size();
    const Reduced done = reduce(map, {.views = target, .bytes = {}}, {});
    EXPECT_TRUE(done.reached);
    EXPECT_EQ(map.content.places.size(), target);
    EXPECT_EQ(done.removed, before - target);
    EXPECT_TRUE(testing::isSound(map.content));
    EXPECT_EQ(testing::parts(map.content), 1u);
    EXPECT_EQ(map.content.path.size(), 48u);
  }
}

TEST(Reduce, RedundantViewsGoFirst) {
  store::WholeMap map = testing::twoDrives(24, 2);  // 12 places have one of the other drive 0.3 m beside them
  reduce(map, {.views = 24, .bytes = {}}, {});
  int beside = 0;
  for (const auto& [id, a] : map.content.places)
    for (const auto& [other, b] : map.content.places)
      beside += id < other && (a.T_map_place.translation() - b.T_map_place.translation()).norm() < 0.4;
  EXPECT_EQ(beside, 0);
}

TEST(Reduce, BytesBoundTheRows) {
  store::WholeMap map = testing::twoDrives(24, 2);
  const Reduced all = reduce(map, {.views = 36, .bytes = {}}, {});
  EXPECT_EQ(all.removed, 0u);
  const Reduced half = reduce(map, {.views = {}, .bytes = all.bytes * 7 / 10}, {});
  EXPECT_TRUE(half.reached);
  EXPECT_LE(half.bytes, all.bytes * 7 / 10);
  EXPECT_GT(map.content.places.size(), 5u);
  EXPECT_FALSE(reduce(map, {.views = {}, .bytes = 10}, {}).reached);  // path and records stay
  EXPECT_EQ(map.content.places.size(), 1u);
}

TEST(Relax, PutsPlacesWhereTheEdgesSay) {
  store::WholeMap map = testing::twoDrives(12, 3);
  const auto truth = map.content.places;
  for (auto& [id, place] : map.content.places)
    if (id.value % 2 == 1) place.T_map_place.translation().x() += 0.4;
  const Relaxed done = relax(map, {});
  EXPECT_GT(done.movedMost, 0.3);
  EXPECT_EQ(done.dropped, 0u);
  for (const auto& [id, place] : map.content.places)
    EXPECT_LT((place.T_map_place.translation() - truth.at(id).T_map_place.translation()).norm(), 1e-3);
  pipeline::PipelineParams scans;
  scans.mapping.nodes = "scans";
  EXPECT_THAT([&] { relax(map, scans); }, ThrowsMessage<base::Error>(HasSubstr("filter")));
}

TEST(DropDrive, WhatNoOtherDriveHasSeenGoes) {
  store::WholeMap map = testing::twoDrives(12, 3);
  const DroppedDrive second = dropDrive(map, 1);
  EXPECT_EQ(second.places, 4u);
  EXPECT_EQ(second.kept, 0u);
  EXPECT_EQ(second.views, 12u);
  EXPECT_EQ(second.pathPoints, 12u);
  EXPECT_EQ(second.records, 12u);
  EXPECT_EQ(map.content.places.size(), 12u);
  EXPECT_EQ(testing::parts(map.content), 1u);
  EXPECT_TRUE(testing::isSound(map.content));
  expectInStep(map);
  EXPECT_THAT([&] { dropDrive(map, 0); }, ThrowsMessage<base::Error>(HasSubstr("the map is empty")));
  EXPECT_THAT([&] { dropDrive(map, 5); }, ThrowsMessage<base::Error>(HasSubstr("no drive 5")));
}

TEST(DropDrive, PlacesThatOthersHaveBeenAtStay) {
  store::WholeMap map = testing::twoDrives(12, 3);
  const DroppedDrive first = dropDrive(map, 0);
  EXPECT_EQ(first.kept, 8u);  // the second drive has views of these
  EXPECT_EQ(first.places, 4u);
  EXPECT_EQ(map.drives.size(), 1u);
  EXPECT_EQ(map.records.front().stamp, 1000.0);
  EXPECT_TRUE(testing::isSound(map.content));
  EXPECT_EQ(testing::parts(map.content), 1u);
  expectInStep(map);
}

TEST(Crop, KeepsTheRegionAndTheWaysThroughTheOutside) {
  store::WholeMap map = testing::twoDrives(24, 3);  // on a circle of 10 m around the origin
  const auto before = map.content.places;
  const Region right{-2, -20, 20, 20};
  const Cropped done = crop(map, right);
  EXPECT_EQ(done.places, before.size() - map.content.places.size());
  for (const auto& [id, place] : before)
    EXPECT_EQ(map.content.places.contains(id), right.contains(place.T_map_place.translation()));
  for (const auto& point : map.content.path) EXPECT_TRUE(map.content.places.contains(point.anchor));
  EXPECT_EQ(testing::parts(map.content), 1u);
  EXPECT_TRUE(testing::isSound(map.content));
  expectInStep(map);
  // The compounded edge says what the chain said.
  for (const auto& [id, edge] : map.content.edges) {
    if (edge.type != map::EdgeType::kCompounded) continue;
    const auto T = before.at(edge.a).T_map_place.inverse() * before.at(edge.b).T_map_place;
    EXPECT_LT((T.translation() - edge.T_a_b.T_a_b.translation()).norm(), 1e-6);
  }
  EXPECT_THAT(
      [&] {
        crop(map, {100, 100, 101, 101});
      },
      ThrowsMessage<base::Error>(HasSubstr("those of the map are at")));
}

TEST(Anonymise, TakesPicturesNamesAndPassersBy) {
  store::WholeMap map = testing::twoDrives(12, 3);
  std::size_t once = 0, longTerm = 0;
  for (const auto& [id, place] : map.content.places) {
    longTerm += place.memory->longTerm().size();
    for (const auto& s : place.memory->states)
      once += s.stage == memory::Stage::kShortTerm && s.age > 0 && s.counter <= 1;
  }
  const Anonymised done = anonymise(map, false);
  EXPECT_EQ(done.pictures, 12u);
  EXPECT_EQ(done.features, once);
  EXPECT_GT(done.names, 0u);
  for (const auto& [id, place] : map.content.places) {
    longTerm -= place.memory->longTerm().size();
    EXPECT_EQ(place.createdLabel, "");
    EXPECT_EQ(place.memory->features.size(), place.memory->states.size());
  }
  EXPECT_EQ(longTerm, 0u);
  for (const auto& [id, view] : map.content.views) EXPECT_TRUE(view.jpeg.empty() && view.label.empty());
  EXPECT_TRUE(testing::isSound(map.content));
  const Anonymised again = anonymise(map, false);
  EXPECT_EQ(again.pictures + again.names + again.features, 0u);
}

TEST(Closures, RejectionsAreRemembered) {
  store::WholeMap map = testing::twoDrives(12, 3);
  const auto before = closures(map, {});
  ASSERT_EQ(before.size(), 5u);  // the ring's loop and four recognitions
  for (const Closure& c : before) EXPECT_NEAR(c.chi2, 0, 1e-6);
  const map::EdgeId id = before.back().id;
  reject(map, std::array{id}, {});
  EXPECT_EQ(closures(map, {}).size(), 4u);
  EXPECT_EQ(rejectionsOf(map.notes), (Rejections{{before.back().a, before.back().b}}));
  EXPECT_THAT([&] { reject(map, std::array{id}, {}); }, ThrowsMessage<base::Error>(HasSubstr("no closure")));
  EXPECT_THAT([&] { reject(map, std::array{map::EdgeId(0)}, {}); },
              ThrowsMessage<base::Error>(HasSubstr("no closure")));
}

TEST(Closures, OneIsAddedWhereMemoriesMatchAndTheGraphAgrees) {
  store::WholeMap map = testing::twoDrives(12, 3);
  const map::PlaceId a(0), b(12);
  reject(map, std::array{closures(map, {})[1].id}, {});
  const Added unlike = addClosure(map, a, map::PlaceId(7), {});
  EXPECT_FALSE(unlike.accepted);
  EXPECT_THAT(unlike.reason, HasSubstr("match"));
  // The same features seen from the same spot.
  base::Rng rng(5);
  map.content.places.at(a).memory = testing::randomMemory(rng, 120, 1);
  map.content.places.at(b).memory = map.content.places.at(a).memory;
  for (auto& [id, edge] : map.content.edges) edge.correspondences.clear();
  const Added added = addClosure(map, a, b, {});
  EXPECT_TRUE(added.accepted) << added.reason;
  EXPECT_GT(added.matches, 40);
  EXPECT_TRUE(map.content.edges.contains(added.edge));
  EXPECT_TRUE(rejectionsOf(map.notes).empty());
  EXPECT_TRUE(testing::isSound(map.content));
}

}  // namespace
}  // namespace engram::keeper

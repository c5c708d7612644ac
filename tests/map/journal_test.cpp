// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/journal.h"

#include "engram/base/rng.h"
#include "engram/map/parts.h"
#include "sample_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>

namespace engram::map::journal {
namespace {

using engram::testing::planarPose;
using engram::testing::ringMap;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

PlaceId p(std::uint32_t v) { return PlaceId(v); }

Edge validEdge(std::uint32_t a, std::uint32_t b) {
  Edge edge;
  edge.a = p(a);
  edge.b = p(b);
  edge.T_a_b = engram::testing::relPose(planarPose(1, 0, 0));
  return edge;
}

TEST(Journal, EveryReaderSeesEveryChangeOnce) {
  auto m = ringMap(3);
  Cursor store, index, late = m.now();
  EXPECT_THAT(m.changesSince(store).places, ElementsAre(p(0), p(1), p(2)));
  EXPECT_TRUE(m.changesSince(store).empty());
  m.setPose(p(1), planarPose(1, 1, 1));
  EXPECT_THAT(m.changesSince(index).places, ElementsAre(p(0), p(1), p(2)));
  EXPECT_THAT(m.changesSince(late).places, ElementsAre(p(1)));
  EXPECT_THAT(m.changesSince(store).places, ElementsAre(p(1)));
  for (Cursor* reader : {&store, &index, &late}) EXPECT_TRUE(m.changesSince(*reader).empty());
}

TEST(Journal, AReaderWhoIsBehindSeesTheOutcomeAlone) {
  auto m = ringMap(3);
  Cursor reader = m.now();
  const auto edge = m.addEdge(validEdge(0, 2));
  for (int i = 0; i < 500; ++i) m.setPose(p(2), planarPose(i, 0, 0));
  m.removeEdge(edge);
  const MapChanges changes = m.changesSince(reader);
  EXPECT_THAT(changes.places, ElementsAre(p(2)));
  EXPECT_THAT(changes.edges, IsEmpty());
  EXPECT_THAT(changes.removedEdges, ElementsAre(edge));
}

/// Also through the sweeps that keep the journal small.
TEST(Journal, ReadersThatFollowHoldWhatTheMapHolds) {
  auto m = ringMap(6);
  base::Rng rng(3);
  std::array<Cursor, 3> cursors;
  std::array<std::set<EdgeId>, 3> edges;
  for (int i = 0; i < 2000; ++i) {
    const auto a = rng.below(6), b = (a + 1 + rng.below(5)) % 6;
    if (m.edges().size() < 12)
      m.addEdge(validEdge(a, b));
    else
      m.removeEdge(std::next(m.edges().begin(), static_cast<int>(rng.below(12)))->first);
    m.setPose(p(a), planarPose(i, 0, 0));
    for (std::size_t k = 0; k < cursors.size(); ++k) {
      if (i % static_cast<int>(1 + 40 * k) != 0) continue;
      const MapChanges changes = m.changesSince(cursors[k]);
      edges[k].insert(changes.edges.begin(), changes.edges.end());
      for (const EdgeId id : changes.removedEdges) edges[k].erase(id);
      std::set<EdgeId> held;
      for (const auto& [id, edge] : m.edges()) held.insert(id);
      ASSERT_EQ(edges[k], held) << i << ' ' << k;
    }
  }
}

TEST(Journal, ACopyIsReadOnWithTheCursorsOfTheOriginal) {
  auto m = ringMap(3);
  Cursor cursor = m.now();
  auto copy = m;
  copy.addPlace({});
  EXPECT_THAT(copy.changesSince(cursor).places, ElementsAre(p(3)));
  Cursor other = m.now();
  EXPECT_TRUE(m.changesSince(other).empty());
}

TEST(Journal, AMapThatWasReadHasNoChanges) {
  const TopologicalMap read{MapContent(ringMap(4).content())};
  Cursor cursor = read.now();
  EXPECT_TRUE(read.changesSince(cursor).empty());
}

/// Parts by the journal against components searched for anew, while passages and places come and go.
TEST(Parts, AreThoseThatASearchFinds) {
  base::Rng rng(4);
  TopologicalMap m;
  for (int i = 0; i < 14; ++i) m.addPlace({});
  Parts parts;
  for (int i = 0; i < 400; ++i) {
    const auto any = [&] {
      return std::next(m.places().begin(),
                       static_cast<int>(rng.below(static_cast<std::uint32_t>(m.places().size()))))
          ->first;
    };
    const PlaceId a = any(), b = any();
    if (i % 3 == 0 && m.edges().size() > 8)
      m.removeEdge(m.edges().begin()->first);
    else if (i % 50 == 49 && m.neighbours(a).size() <= 1 && a != b)
      m.removePlace(a, b);
    else if (a != b) {
      Edge edge = validEdge(a.value, b.value);
      if (i % 5 == 0) edge.type = EdgeType::kWeak;
      m.addEdge(edge);
    }
    parts.follow(m);
    for (const auto& [id, place] : m.places()) {
      const auto reached = m.hopDistances(id, 100);
      std::set<PlaceId> expected;
      for (const auto& [other, hops] : reached) expected.insert(other);
      ASSERT_EQ(parts.placesOf(id), expected) << i;
    }
  }
}

TEST(Parts, TheYoungerMovesToWhereTheEdgePutsIt) {
  TopologicalMap m;
  for (int i = 0; i < 4; ++i) {
    Place place;
    place.T_map_place = planarPose(i, 0, 0);
    m.addPlace(std::move(place));
  }
  for (const std::uint32_t a : {0u, 2u}) m.addEdge(validEdge(a, a + 1));
  Parts parts;
  parts.follow(m);
  const auto moved = aligned(m, parts, p(3), p(1), planarPose(0, 5, 0));
  ASSERT_EQ(moved.size(), 2u);
  EXPECT_TRUE((moved.at(p(3)).inverse() * m.place(p(1)).T_map_place).isApprox(planarPose(0, 5, 0), 1e-12));
  EXPECT_TRUE((moved.at(p(2)).inverse() * moved.at(p(3))).isApprox(planarPose(1, 0, 0), 1e-12));
  EXPECT_TRUE(aligned(m, parts, p(0), p(1), planarPose(7, 0, 0)).empty());
}

TEST(Parts, WeakEdgesGoOnceBothSidesAreJoined) {
  TopologicalMap m;
  for (int i = 0; i < 4; ++i) m.addPlace({});
  Edge weak = validEdge(0, 3);
  weak.type = EdgeType::kWeak;
  m.addEdge(weak);
  m.addEdge(validEdge(0, 1));
  Parts parts;
  EXPECT_FALSE(dropJoinedWeakEdges(m, parts));
  m.addEdge(validEdge(1, 2));
  m.addEdge(validEdge(2, 3));
  EXPECT_TRUE(dropJoinedWeakEdges(m, parts));
  EXPECT_EQ(m.edges().size(), 3u);
}

}  // namespace
}  // namespace engram::map::journal

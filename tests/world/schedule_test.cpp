// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/schedule.h"

#include "engram/base/error.h"
#include "tiny_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <vector>

namespace engram::world {
namespace {

const Building& office() {
  static const Building building(presetPlan("office", 1), 1);
  return building;
}

TEST(Building, FillsAnOffice) {
  std::size_t rooms = 0;
  for (const auto& r : office().rooms()) rooms += !r.isCorridor();
  EXPECT_GE(rooms, 12u);
  EXPECT_GE(office().posterSpots().size(), 40u);
  EXPECT_GE(office().furniture().size(), 60u);
  EXPECT_GE(office().doors().size(), 15u);
  for (std::size_t i = 0; i < office().furniture().size(); ++i)
    EXPECT_TRUE(office().fits(office().furniture()[i], office().furniture(), static_cast<int>(i))) << i;
}

// Storeys have the same walls, furniture and most posters at the same places; doors have numbers of their
// own.
TEST(Building, StoreysAreAlike) {
  const Building tower(presetPlan("tower", 1), 1);
  const Plan& plan = tower.plan();
  ASSERT_EQ(plan.storeys, 5);
  const auto storeyOf = [&](int cell) { return cell % plan.columns / plan.pitch(); };
  const auto within = [&](int cell) { return cell - storeyOf(cell) * plan.pitch(); };
  std::vector<int> spots(5), pieces(5);
  std::map<int, std::set<std::uint32_t>> numbers;
  for (std::size_t i = 0; i < tower.posterSpots().size(); ++i) {
    const int cell = tower.posterSpots()[i].cell;
    const auto model = static_cast<std::size_t>(tower.posterModels()[i]);
    EXPECT_EQ(within(cell), within(tower.posterSpots()[model].cell)) << i;
    EXPECT_EQ(storeyOf(tower.posterSpots()[model].cell), 2) << i;
    ++spots[static_cast<std::size_t>(storeyOf(cell))];
  }
  for (const Furniture& f : tower.furniture())
    ++pieces[static_cast<std::size_t>(storeyOf(tower.cellAt(f.centre.x(), f.centre.y())))];
  for (const FixedSpot& f : tower.fixtures())
    if (f.kind == Fixture::kDoorSign) numbers[within(f.spot.cell) * 4 + f.spot.side].insert(f.look);
  for (std::size_t k = 1; k < 4; ++k) {  // those in between have a storey on either side
    EXPECT_EQ(spots[k], spots[2]) << k;
    EXPECT_EQ(pieces[k], pieces[2]) << k;
  }
  EXPECT_GE(spots[2], 10);
  EXPECT_GE(pieces[2], 10);
  for (const auto& [where, looks] : numbers) EXPECT_GE(looks.size(), 3u) << where;

  const Appearance day = Schedule(tower, {}).session(1);
  double same = 0, all = 0;
  for (std::size_t i = 0; i < day.posters.size(); ++i) {
    const auto model = static_cast<std::size_t>(tower.posterModels()[i]);
    if (model == i) continue;
    ++all;
    same += day.posters[i] == day.posters[model];
  }
  EXPECT_NEAR(same / all, 2.0 / 3, 0.15);
}

// Each session replaces exactly the configured share of posters, and no more of anything than asked.
TEST(Schedule, ChangesTheConfiguredShares) {
  ChangeParams p;
  p.poster_share = 0.25, p.furniture_share = 0.3, p.door_share = 0.5;
  Schedule schedule(office(), p);
  for (int n = 2; n <= 6; ++n) {
    const Appearance a = schedule.session(n - 1), b = schedule.session(n);
    int posters = 0, furniture = 0, doors = 0;
    for (std::size_t i = 0; i < a.posters.size(); ++i) posters += a.posters[i] != b.posters[i];
    for (std::size_t i = 0; i < a.furniture.size(); ++i)
      furniture += a.furniture[i].centre != b.furniture[i].centre;
    for (std::size_t i = 0; i < a.doorOpen.size(); ++i) doors += a.doorOpen[i] != b.doorOpen[i];
    EXPECT_EQ(posters, std::lround(0.25 * static_cast<double>(a.posters.size())));
    EXPECT_EQ(posters, b.changedPosters);
    EXPECT_EQ(furniture, b.movedFurniture);
    EXPECT_EQ(furniture, std::lround(0.3 * static_cast<double>(a.furniture.size())));
    EXPECT_EQ(doors, b.changedDoors);
    for (std::size_t i = 0; i < office().doors().size(); ++i)
      EXPECT_TRUE(b.doorOpen[i] || !office().doors()[i].onRoute);
    EXPECT_GT(b.stamp(), a.stamp());
  }
}

TEST(Schedule, IsDeterministicAndCanStandStill) {
  ChangeParams still{.poster_share = 0, .furniture_share = 0, .door_share = 0, .light = false};
  Schedule s(office(), still);
  const Appearance first = s.session(1), fifth = s.session(5);
  EXPECT_EQ(first.posters, fifth.posters);
  EXPECT_EQ(first.doorOpen, fifth.doorOpen);
  EXPECT_EQ(first.lampOn, fifth.lampOn);
  EXPECT_EQ(first.hour, fifth.hour);
  Schedule a(office(), {}), b(office(), {});
  b.session(8);
  EXPECT_EQ(a.session(3).posters, b.session(3).posters);
  EXPECT_EQ(a.session(3).inWords(), b.session(3).inWords());
  EXPECT_THROW(a.session(0), base::Error);
}

TEST(Schedule, SunRisesInTheEastAndIsHighestAtNoon) {
  Schedule s(office(), {});
  std::set<int> seasons;
  bool dark = false, bright = false;
  for (int n = 1; n <= 20; ++n) {
    const Appearance a = s.session(n);
    EXPECT_NEAR(a.toSun.norm(), 1, 1e-5);
    EXPECT_EQ(a.toSun.x() > 0, a.hour < 12) << a.inWords();
    if (a.hour > 21) {
      EXPECT_LT(a.toSun.z(), 0.0f);
    }
    if (std::abs(a.hour - 12) < 1) {
      EXPECT_GT(a.toSun.z(), 0.3f);
    }
    seasons.insert(a.season);
    dark |= (a.daylight < 0.1f).all();
    bright |= (a.daylight.head<3>() > 2.0f).all();
  }
  EXPECT_GE(seasons.size(), 3u);
  EXPECT_TRUE(dark && bright);
}

// Listed sessions change by the sudden share, the others by their own; and what is not listed is as ever.
TEST(Schedule, ChangesSuddenlyWhereAskedTo) {
  ChangeParams p;
  p.poster_share = 0.05, p.sudden_share = 0.6, p.sudden_sessions = "3, 5";
  Schedule schedule(office(), p);
  const auto posters = static_cast<double>(office().posterSpots().size());
  for (int n = 2; n <= 6; ++n) {
    const double share = n == 3 || n == 5 ? 0.6 : 0.05;
    EXPECT_EQ(schedule.session(n).changedPosters, std::lround(share * posters)) << n;
  }
  ChangeParams plain = p;
  plain.sudden_sessions.clear();
  Schedule calm(office(), plain);
  EXPECT_EQ(schedule.session(2).inWords(), calm.session(2).inWords());
  EXPECT_EQ(schedule.session(2).posters, calm.session(2).posters);
  EXPECT_NE(schedule.session(3).posters, calm.session(3).posters);
}

TEST(Schedule, RefusesSuddenSessionsThatAreNoNumbers) {
  for (const char* text : {"3,x", "1", "2.5"}) {
    ChangeParams p;
    p.sudden_sessions = text;
    EXPECT_THROW(Schedule(office(), p), base::Error) << text;
  }
}

// The hour moves sun and lamps and nothing else; the way there does not matter.
TEST(Schedule, SetsTheHourOfADay) {
  Schedule s(office(), {});
  const Appearance day = s.session(4);
  const Appearance noon = s.atHour(day, 12), night = s.atHour(day, 23);
  EXPECT_EQ(noon.hour, 12);
  EXPECT_GT(noon.toSun.z(), 0.3f);
  EXPECT_LT(night.toSun.z(), 0.0f);
  EXPECT_GT(noon.daylight.sum(), 10 * night.daylight.sum());
  EXPECT_EQ(noon.posters, day.posters);
  EXPECT_EQ(noon.doorOpen, day.doorOpen);
  EXPECT_EQ(noon.cloud, day.cloud);
  EXPECT_EQ(std::floor(noon.stamp() / 86400), std::floor(day.stamp() / 86400));
  EXPECT_EQ(s.atHour(night, 12).lampOn, noon.lampOn);
  EXPECT_THROW(s.atHour(day, 24), base::Error);
}

}  // namespace
}  // namespace engram::world

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/schedule.h"

#include "engram/base/error.h"
#include "engram/base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

namespace engram::world {
namespace {

constexpr double kFirstDay = 1740960000;  // 2025-03-03T00:00:00Z
constexpr int kFirstDayOfYear = 61;
constexpr double kLatitude = 42 * std::numbers::pi / 180;
constexpr std::uint32_t kOwnPosters = 3;      // one in so many is that of the storey; the others hang in all
constexpr std::uint32_t kPosterDesigns = 60;  // few enough that some hang in several places

// n different numbers below `size`, in random order.
std::vector<int> choose(int n, int size, base::Rng& rng) {
  std::vector<int> all(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) all[static_cast<std::size_t>(i)] = i;
  for (int i = 0; i < n; ++i)
    std::swap(all[static_cast<std::size_t>(i)],
              all[static_cast<std::size_t>(i) + rng.below(static_cast<std::uint32_t>(size - i))]);
  all.resize(static_cast<std::size_t>(n));
  return all;
}

std::set<int> readSessions(const std::string& text) {
  std::string list = text;
  std::replace(list.begin(), list.end(), ',', ' ');
  std::istringstream in(list);
  std::set<int> sessions;
  for (std::string word; in >> word;) {
    int number = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (status != std::errc() || end != word.data() + word.size() || number < 2)
      throw base::Error("[change] sudden_sessions = " + base::printable(text) + ": " + base::quoted(word) +
                        " is no session from 2 on; give numbers such as 10,20");
    sessions.insert(number);
  }
  return sessions;
}

int share(double s, std::size_t n) { return static_cast<int>(std::lround(s * static_cast<double>(n))); }

}  // namespace

void ChangeParams::describe(base::Params& p) {
  p.add("poster_share", poster_share, "share of the posters replaced before each session", {0, 1});
  p.add("furniture_share", furniture_share, "share of the furniture moved before each session", {0, 1});
  p.add("door_share", door_share, "share of the doors off the route opened or closed before each session",
        {0, 1});
  p.add("sudden_sessions", sudden_sessions,
        "sessions before which much changes at once, such as 10,20; empty: none");
  p.add("sudden_share", sudden_share, "share of posters, furniture and doors that changes before those",
        {0, 1});
  p.add("days", days, "mean time between sessions [day]", {0, 365});
  p.add("people", people, "people walking about", {0, 100});
  p.add("light", light, "hour and weather change; off: every session at noon with the lamps on");
}

double Appearance::stamp() const { return kFirstDay + std::floor(day) * 86400.0 + hour * 3600.0; }

std::string Appearance::inWords() const {
  static const char* const seasons[]{"winter", "spring", "summer", "autumn"};
  const char* weather = toSun.z() < 0 ? "dark"
                        : cloud > 0.6 ? "overcast"
                        : cloud > 0.3 ? "some clouds"
                                      : "sunny";
  const auto on = std::count(lampOn.begin(), lampOn.end(), true);
  const auto open = std::count(doorOpen.begin(), doorOpen.end(), true);
  char text[256];
  std::snprintf(text, sizeof text,
                "day %.0f, %02d:%02d, %s, %s; %d of %d lamps on, %d of %d doors open, %d people; since the "
                "session before "
                "%d posters, %d pieces of furniture and %d doors changed",
                std::floor(day), static_cast<int>(hour), static_cast<int>(hour * 60) % 60, seasons[season],
                weather, static_cast<int>(on), static_cast<int>(lampOn.size()), static_cast<int>(open),
                static_cast<int>(doorOpen.size()), people, changedPosters, movedFurniture, changedDoors);
  return text;
}

Schedule::Schedule(const Building& building, const ChangeParams& params)
    : building_(building), params_(params), sudden_(readSessions(params.sudden_sessions)) {
  base::validate(params);
}

const Appearance& Schedule::session(int number) {
  if (number < 1 || number > 10000)
    throw base::Error("session " + std::to_string(number) + " is not in 1 .. 10000");
  if (sessions_.empty()) sessions_.push_back(opening());
  while (static_cast<int>(sessions_.size()) < number) sessions_.push_back(next(sessions_.back()));
  return sessions_[static_cast<std::size_t>(number - 1)];
}

void Schedule::setTime(Appearance& a, base::Rng rng) const {
  static constexpr double hours[]{10.5, 15.5, 20.8, 12.5, 8.3, 17.2, 21.5, 13.5};
  a.hour = params_.light ? hours[(a.session - 1) % 8] + rng.uniform(-0.5, 0.5) : 12.0;
  a.cloud = params_.light ? (a.session == 1 ? 0.25 : rng.uniform()) : 0.8;
  setLight(a, rng);
}

Appearance Schedule::atHour(Appearance a, double hour) const {
  if (hour < 0 || hour >= 24) throw base::Error("hour " + std::to_string(hour) + " is not in [0, 24)");
  a.hour = hour;
  // One stream a day: a lamp that the day's dusk switches on stays on.
  base::Rng rng = base::Rng(building_.seed()).fork(20000 + static_cast<std::uint64_t>(a.session));
  if (params_.light) setLight(a, rng);
  return a;
}

void Schedule::setLight(Appearance& a, base::Rng& rng) const {
  const double year = std::fmod(kFirstDayOfYear + a.day, 365.0);
  a.season = params_.light ? static_cast<int>(std::fmod(year + 31, 365.0) / 91.25) : 2;
  const double declination =
      -23.44 * std::numbers::pi / 180 * std::cos(2 * std::numbers::pi * (year + 10) / 365);
  const double angle = (a.hour - 12) * std::numbers::pi / 12;
  const double up = std::sin(kLatitude) * std::sin(declination) +
                    std::cos(kLatitude) * std::cos(declination) * std::cos(angle);
  const double west = std::cos(declination) * std::sin(angle);
  const double south = std::sin(kLatitude) * std::cos(declination) * std::cos(angle) -
                       std::cos(kLatitude) * std::sin(declination);
  a.toSun = Eigen::Vector3d(-west, -south, up).normalized().cast<float>();  // x east, y north

  const double day = std::clamp(0.12 + 1.1 * up, 0.0, 1.0);  // some light is left in the dusk
  const Colour blue = bgr(1.12f, 1.0f, 0.9f), warm = bgr(0.72f, 0.95f, 1.15f);
  const auto low = static_cast<float>(std::clamp(1.0 - up * 2.5, 0.0, 1.0));
  a.daylight =
      (blue * (1 - low * 0.6f) + warm * low * 0.6f) * static_cast<float>(day * (6.5 - 3.0 * a.cloud)) +
      bgr(0.02f, 0.012f, 0.01f);
  a.sunlight = Colour::Zero();
  if (up > 0.03 && a.cloud < 0.55)
    a.sunlight = (bgr(0.8f, 0.95f, 1.05f) * (1 - low) + bgr(0.45f, 0.8f, 1.1f) * low) *
                 static_cast<float>(9.0 * (1 - a.cloud) * std::sqrt(up));
  a.people = params_.people;
  const bool dark = up<0.15, work = a.hour> 7.5 && a.hour < 19;
  a.lampOn.resize(building_.lamps().size());
  std::vector<bool> roomLit(building_.rooms().size());
  for (std::size_t r = 0; r < roomLit.size(); ++r) {
    const bool corridor = building_.rooms()[r].isCorridor();
    roomLit[r] = building_.plan().open
                     ? dark
                     : !params_.light || rng.uniform() < (corridor ? (dark || work ? 1.0 : 0.6)
                                                          : dark   ? 0.75
                                                                   : 0.45);
  }
  for (std::size_t i = 0; i < a.lampOn.size(); ++i)
    a.lampOn[i] = roomLit[static_cast<std::size_t>(building_.lamps()[i].room)] &&
                  (!params_.light || rng.uniform() > 0.06);
}

Appearance Schedule::opening() const {
  base::Rng rng = base::Rng(building_.seed()).fork(1000);
  Appearance a;
  a.furniture = building_.furniture();
  for (std::size_t i = 0; i < building_.posterSpots().size(); ++i)
    a.posters.push_back(rng.below(kPosterDesigns));
  for (std::size_t i = 0; i < a.posters.size(); ++i) {
    const auto model = static_cast<std::size_t>(building_.posterModels()[i]);
    if (model != i && rng.below(kOwnPosters) > 0) a.posters[i] = a.posters[model];
  }
  for (const auto& door : building_.doors()) a.doorOpen.push_back(door.onRoute || rng.uniform() < 0.35);
  setTime(a, rng.fork(1));
  return a;
}

Appearance Schedule::next(const Appearance& before) const {
  Appearance a = before;
  a.session = before.session + 1;
  base::Rng rng = base::Rng(building_.seed()).fork(1000 + static_cast<std::uint64_t>(a.session));
  a.day = std::floor(before.day) + std::max(1.0, std::floor(params_.days * rng.uniform(0.4, 1.6)));
  const bool sudden = sudden_.count(a.session) > 0;
  const auto changed = [&](double gradual, std::size_t n) {
    return share(sudden ? params_.sudden_share : gradual, n);
  };
  const int posters = changed(params_.poster_share, a.posters.size());
  for (const int i : choose(posters, static_cast<int>(a.posters.size()), rng)) {
    auto& poster = a.posters[static_cast<std::size_t>(i)];
    poster = (poster + 1 + rng.below(kPosterDesigns - 1)) % kPosterDesigns;  // never the same again
  }
  a.changedPosters = posters;
  a.movedFurniture = 0;
  const int pieces = changed(params_.furniture_share, a.furniture.size()),
            all = static_cast<int>(a.furniture.size());
  for (const int i : choose(all, all, rng)) {  // in random order: some have nowhere to go
    if (a.movedFurniture == pieces) break;
    a.movedFurniture += building_.place(a.furniture[static_cast<std::size_t>(i)], a.furniture, i, rng);
  }
  std::vector<int> movable;
  for (std::size_t i = 0; i < a.doorOpen.size(); ++i)
    if (!building_.doors()[i].onRoute) movable.push_back(static_cast<int>(i));
  a.changedDoors = changed(params_.door_share, movable.size());
  for (const int i : choose(a.changedDoors, static_cast<int>(movable.size()), rng)) {
    const auto d = static_cast<std::size_t>(movable[static_cast<std::size_t>(i)]);
    a.doorOpen[d] = !a.doorOpen[d];
  }
  setTime(a, rng.fork(1));
  return a;
}

}  // namespace engram::world

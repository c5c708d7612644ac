// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/world/building.h"
#include "engram/world/texture.h"

#include <Eigen/Core>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace engram::world {

/// How the building changes from one session to the next. Section [change].
struct ChangeParams {
  double poster_share = 0.15;        ///< of the posters replaced before each session
  double furniture_share = 0.2;      ///< of the furniture moved before each session
  double door_share = 0.3;           ///< of the doors off the route opened or closed
  std::string sudden_sessions = {};  ///< numbers of sessions before which much changes at once: "10,20"
  double sudden_share = 0.4;         ///< of the posters, furniture and doors that changes before those
  double days = 21;                  ///< mean time between sessions [day]
  int people = 6;                    ///< walking about
  bool light = true;  ///< hour and weather change; off: every session at noon with the lamps on
  void describe(base::Params& p);
};

/// What one session looks like: everything that changes. A value; the same building, seed and number give the
/// same.
struct Appearance {
  int session = 1;
  double day = 0;                                    ///< since 2025-03-03
  double hour = 12;                                  ///< local solar time [h]
  int season = 1;                                    ///< 0 winter, 1 spring, 2 summer, 3 autumn
  double cloud = 0;                                  ///< 0 clear … 1 overcast
  Eigen::Vector3f toSun = Eigen::Vector3f::UnitZ();  ///< unit vector to the sun; below the horizon at night
  Colour daylight = Colour::Zero();                  ///< radiance of the sky through the windows
  Colour sunlight = Colour::Zero();    ///< irradiance of direct sun; zero under clouds and at night
  std::vector<bool> lampOn;            ///< Building::lamps
  std::vector<std::uint32_t> posters;  ///< look of the poster at each of Building::posterSpots
  std::vector<Furniture> furniture;
  std::vector<bool> doorOpen;  ///< Building::doors
  int people = 0;
  int changedPosters = 0, movedFurniture = 0, changedDoors = 0;  ///< since the session before
  double stamp() const;                                          ///< Unix time of the start [s]
  std::string inWords() const;
};

/// The sessions of a building in order: days or weeks apart, at changing hours.
class Schedule {
 public:
  Schedule(const Building& building, const ChangeParams& params);
  /// @param number from 1
  const Appearance& session(int number);
  /// The same day at another hour [h]: sun, daylight and lamps follow; `cloud` and all else stay. Without
  /// ChangeParams::light only the hour changes.
  Appearance atHour(Appearance appearance, double hour) const;

 private:
  Appearance opening() const;
  Appearance next(const Appearance& before) const;
  void setTime(Appearance& a, base::Rng rng) const;
  void setLight(Appearance& a, base::Rng& rng) const;

  const Building& building_;
  ChangeParams params_;
  std::set<int> sudden_;  // sessions
  std::vector<Appearance> sessions_;
};

}  // namespace engram::world

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace engram::world {

/// The floor plan of a building as a grid of characters, and the nominal route of the robot in it.
///
/// Text form; `#` at the start of a line that is not in the grid begins a comment:
///
///     name   hall
///     cell   0.5            side of a grid cell [m]
///     height 2.7            floor to ceiling [m]
///     roof   none           streets under the sky, `height` is that of the houses; default: flat
///     storeys 5             that look alike, laid out side by side along x: an equal share of the columns
///     each route  1.5,1.5 6,1.5 6,4 1.5,4     closed tour through these points [m]; may be repeated to go on
///     grid                  first line is the far side (largest y), first character is x = 0
///     ################
///     #......+aaaaaaa=
///     ################
///     end
///
/// `#` wall, blank outside, `.` corridor, `a` … `z` a room (connected cells of one letter), `+` door in a
/// wall,
/// `=` window in an outer wall. Frame `world`: x right, y up in the grid, origin at its lower left corner.
struct Plan {
  std::string name = "plan";
  double cell = 0.5;    ///< [m]
  double height = 2.7;  ///< [m]
  bool open = false;    ///< no roof: streets between houses
  int storeys = 1;      ///< side by side along x, alike but for door numbers and some posters
  int columns = 0, rows = 0;
  std::vector<char> cells;             ///< rows x columns, row 0 at y = 0
  std::vector<Eigen::Vector2d> route;  ///< [m]; the tour returns from the last to the first

  /// The character at a cell; blank outside the grid.
  char at(int column, int row) const {
    return column < 0 || row < 0 || column >= columns || row >= rows ? ' ' : cells[row * columns + column];
  }
  /// Columns from a storey to the next.
  int pitch() const { return columns / storeys; }
  double width() const { return columns * cell; }
  double depth() const { return rows * cell; }
  std::string toText() const;
};

inline bool isFloor(char c) { return c == '.' || (c >= 'a' && c <= 'z'); }

/// Reads the text form. Throws base::Error with `name`, line and what to do: unknown characters, floor beside
/// the outside, doors and windows that lead nowhere, a route through walls or with a reversal.
Plan parsePlan(const std::string& text, const std::string& name);
Plan loadPlan(const std::string& path);

/// `tiny` (one corridor and a room in a loop of 20 m), `office` (a corridor loop, 15 rooms, tour of about 80
/// m), `corridors` (a ladder of self-similar corridors), `campus` (streets under the sky, tour of about 145
/// m), `loops` (a small loop in a room, then a long one in a corridor, about 100 m), `rooms` (two and a
/// corridor between them) or `tower` (five storeys alike, joined by stairs, up and down again, about 290 m).
/// The seed varies the sizes of rooms and the places of doors.
Plan presetPlan(const std::string& preset, std::uint64_t seed);
const std::vector<std::string>& presetNames();

}  // namespace engram::world

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/base/rng.h"
#include "engram/world/plan.h"

namespace engram::world {
namespace {

// Draws on the grid of a plan; all numbers are cells, intervals are closed.
class Draughtsman {
 public:
  Draughtsman(const std::string& name, int columns, int rows) {
    plan.name = name;
    plan.columns = columns, plan.rows = rows;
    plan.cells.assign(static_cast<std::size_t>(columns) * rows, ' ');
  }
  void fill(int x0, int y0, int x1, int y1, char c) {
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) plan.cells[y * plan.columns + x] = c;
  }
  void doorH(int x, int y) { fill(x, y, x + 1, y, '+'); }  // two cells wide, in a wall along x
  void doorV(int x, int y) { fill(x, y, x, y + 1, '+'); }
  void visit(double x, double y) { plan.route.emplace_back(x * plan.cell, y * plan.cell); }

  Plan plan;
};

// Windows of `width` cells every `pitch` cells along a room's outer wall at row y.
void windowsH(Draughtsman& d, int x0, int x1, int y, int width, int pitch) {
  const int count = std::max(1, (x1 - x0 + 1 - 1) / pitch);
  const int used = count * pitch - (pitch - width);
  int x = x0 + (x1 - x0 + 1 - used) / 2;
  for (int i = 0; i < count; ++i, x += pitch) d.fill(x, y, x + width - 1, y, '=');
}

struct RoomSpan {
  int x0, x1;  // closed interval of columns
};

// Splits columns x0 .. x1 into n rooms with one wall between; sizes vary by one or two cells with the seed.
std::vector<RoomSpan> splitRow(int x0, int x1, int n, base::Rng& rng) {
  std::vector<RoomSpan> rooms;
  int x = x0;
  for (int i = 0; i < n; ++i) {
    const int left = n - i;
    const int mean = (x1 - x + 1 - (left - 1)) / left;
    const int size = left == 1 ? x1 - x + 1 : mean + static_cast<int>(rng.below(3)) - 1;
    rooms.push_back({x, x + size - 1});
    x += size + 1;
  }
  return rooms;
}

// One row of rooms along a corridor. Rooms with an entry in `toured` get two doors, the others one.
// `doorRow` is the wall row towards the corridor.
void drawRooms(Draughtsman& d, const std::vector<RoomSpan>& rooms, int y0, int y1, int doorRow,
               const std::vector<bool>& toured, char first, base::Rng& rng) {
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    const auto [x0, x1] = rooms[i];
    d.fill(x0, y0, x1, y1, static_cast<char>(first + i));
    if (toured[i]) {
      d.doorH(x0, doorRow);
      d.doorH(x1 - 1, doorRow);
    } else {
      d.doorH(x0 + static_cast<int>(rng.below(static_cast<std::uint32_t>(x1 - x0 - 1))), doorRow);
    }
  }
}

// Leaves the corridor through one door of a room and comes back through the other. `ahead` is +1 when
// travelling to +x.
void visitRoom(Draughtsman& d, const RoomSpan& room, double corridorY, double roomY, int ahead) {
  const double in = ahead > 0 ? room.x0 + 1 : room.x1;
  const double out = ahead > 0 ? room.x1 : room.x0 + 1;
  d.visit(in, corridorY);
  d.visit(in, roomY);
  d.visit(out, roomY);
  d.visit(out, corridorY);
}

// A U of corridors closed by a room with two doors; two more rooms to look into.
Plan tinyPlan() {
  Draughtsman d("tiny", 19, 20);
  d.fill(1, 1, 17, 18, '#');
  d.fill(2, 2, 16, 4, '.');                            // corridor in the south
  d.fill(2, 5, 4, 8, '.'), d.fill(14, 5, 16, 8, '.');  // west and east
  d.fill(2, 10, 16, 13, 'a');                          // the room that closes the loop
  d.fill(6, 6, 12, 8, 'b');                            // inside the loop
  d.fill(2, 15, 16, 17, 'c');                          // behind it
  d.doorH(3, 9), d.doorH(14, 9);
  d.doorH(8, 5), d.doorH(11, 14);
  d.fill(6, 1, 7, 1, '='), d.fill(11, 1, 12, 1, '=');
  d.fill(17, 11, 17, 12, '='), d.fill(1, 11, 1, 12, '=');
  d.fill(4, 18, 5, 18, '='), d.fill(8, 18, 9, 18, '=');
  for (const auto& [x, y] : {std::pair{4.0, 3.5}, {15.0, 3.5}, {15.0, 12.0}, {4.0, 12.0}}) d.visit(x, y);
  return d.plan;
}

// Corridor ring of 22 x 5.5 m, six rooms on each long side, three inside; the tour goes through four rooms.
Plan officePlan(base::Rng rng) {
  Draughtsman d("office", 54, 40);
  d.fill(1, 1, 52, 38, '#');
  d.fill(2, 12, 51, 15, '.'), d.fill(2, 23, 51, 26, '.');
  d.fill(2, 16, 5, 22, '.'), d.fill(48, 16, 51, 22, '.');
  const auto north = splitRow(2, 51, 6, rng), south = splitRow(2, 51, 6, rng),
             inner = splitRow(7, 46, 3, rng);
  const std::vector<bool> toured{false, true, false, false, true, false};
  drawRooms(d, south, 2, 10, 11, toured, 'a', rng);
  drawRooms(d, north, 28, 37, 27, toured, 'g', rng);
  drawRooms(d, inner, 17, 21, 16, {false, false, false}, 'm', rng);
  for (const auto& r : south) windowsH(d, r.x0, r.x1, 1, 2, 3);
  for (const auto& r : north) windowsH(d, r.x0, r.x1, 38, 2, 3);
  for (const int x : {1, 52})
    for (const int y : {13, 19, 24}) d.fill(x, y, x, y + 1, '=');
  d.visit(4, 14);
  visitRoom(d, south[1], 14, 7, +1);
  visitRoom(d, south[4], 14, 7, +1);
  d.visit(50, 14);
  d.visit(50, 25);
  visitRoom(d, north[4], 25, 32, -1);
  visitRoom(d, north[1], 25, 32, -1);
  d.visit(4, 25);
  return d.plan;
}

// A ladder: two long corridors and three cross corridors with the same doors at the same distances.
Plan corridorsPlan(base::Rng rng) {
  Draughtsman d("corridors", 72, 36);
  d.fill(1, 1, 70, 34, '#');
  for (const int y : {7, 16, 25}) d.fill(2, y, 69, y + 3, '.');
  for (const int x : {2, 34, 66}) d.fill(x, 7, x + 3, 28, '.');
  const int shift = static_cast<int>(rng.below(3));
  char letter = 'a';
  for (const int left : {7, 39})
    for (int i = 0; i < 3; ++i) {
      const int x0 = left + 9 * i, x1 = x0 + 7;
      d.fill(x0, 2, x1, 5, letter), d.fill(x0, 30, x1, 33, letter);
      d.fill(x0, 12, x1, 14, letter), d.fill(x0, 21, x1, 23, letter);
      letter = static_cast<char>(letter + 1);
      for (const int y : {6, 11, 15, 20, 24, 29}) {
        if (y == 15 || y == 24) continue;
        d.doorH(x0 + 2 + shift, y);
      }
      windowsH(d, x0, x1, 1, 2, 4), windowsH(d, x0, x1, 34, 2, 4);
    }
  for (const int x : {1, 70})
    for (const int y : {8, 17, 26}) d.fill(x, y, x, y + 1, '=');
  for (const auto& [x, y] : {std::pair{4, 9}, {36, 9}, {36, 18}, {68, 18}, {68, 27}, {4, 27}}) d.visit(x, y);
  return d.plan;
}

// Three by three streets of 6 m between four blocks of houses; the tour goes round two of them.
Plan campusPlan(base::Rng rng) {
  const int wide = 30 + static_cast<int>(rng.below(3)), deep = 18 + static_cast<int>(rng.below(3));
  const int street = 12, margin = 2;
  const int x1 = margin + street + wide, x2 = x1 + street + wide;  // where the second and third street begin
  const int y1 = margin + street + deep, y2 = y1 + street + deep;
  Draughtsman d("campus", x2 + street + margin, y2 + street + margin);
  d.plan.height = 9;
  d.plan.open = true;
  d.fill(0, 0, d.plan.columns - 1, d.plan.rows - 1, '#');
  char letter = 'a';
  for (const int x : {margin, x1, x2}) d.fill(x, margin, x + street - 1, y2 + street - 1, letter++);
  for (const int y : {margin, y1, y2}) d.fill(margin, y, x2 + street - 1, y + street - 1, '.');
  const double half = street / 2.0;
  const auto corner = [&](int x, int y) { d.visit(x + half, y + half); };
  corner(margin, margin), corner(x1, margin), corner(x1, y1), corner(x2, y1), corner(x2, y2),
      corner(margin, y2);
  return d.plan;
}

// A ring of corridors with rooms on all sides. The tour circles once in the first room, crosses the beginning
// of that loop again for two metres, goes on round the ring and comes back: the kind of drive of Angeli et
// al. 2009.
Plan loopsPlan(base::Rng rng) {
  Draughtsman d("loops", 64, 44);
  d.fill(1, 1, 62, 42, '#');
  d.fill(2, 14, 61, 17, '.'), d.fill(2, 33, 61, 36, '.');
  d.fill(2, 18, 5, 32, '.'), d.fill(58, 18, 61, 32, '.');
  d.fill(2, 2, 15, 12, 'a');  // the room of the small loop
  d.doorH(4, 13), d.doorH(8, 13);
  const auto south = splitRow(17, 61, 4, rng), inner = splitRow(7, 56, 4, rng),
             north = splitRow(2, 61, 5, rng);
  drawRooms(d, south, 2, 12, 13, std::vector<bool>(4, false), 'b', rng);
  drawRooms(d, inner, 19, 31, 18, std::vector<bool>(4, false), 'f', rng);
  drawRooms(d, north, 38, 41, 37, std::vector<bool>(5, false), 'j', rng);
  windowsH(d, 2, 15, 1, 2, 3);
  for (const auto& r : south) windowsH(d, r.x0, r.x1, 1, 2, 4);
  for (const auto& r : north) windowsH(d, r.x0, r.x1, 42, 2, 4);
  for (const int x : {1, 62})
    for (const int y : {15, 24, 34}) d.fill(x, y, x, y + 1, '=');
  for (const auto& [x, y] : {std::pair{5.0, 4.0},
                             {13.0, 4.0},
                             {13.0, 10.0},
                             {5.0, 10.0},
                             {5.0, 4.2},
                             {9.0, 4.2},
                             {9.0, 15.5},
                             {60.0, 15.5},
                             {60.0, 34.5},
                             {4.0, 34.5},
                             {4.0, 15.5},
                             {5.0, 15.5}})
    d.visit(x, y);
  return d.plan;
}

// Two rooms and a corridor between them. The tour leaves the first, goes round in the second, and comes back
// through the same corridor: the drive of Bertolli et al. 2006.
Plan roomsPlan() {
  Draughtsman d("rooms", 44, 12);
  d.fill(1, 1, 42, 10, '#');
  d.fill(2, 2, 13, 9, 'a'), d.fill(30, 2, 41, 9, 'b');
  d.fill(15, 4, 28, 7, '.');
  d.doorV(14, 5), d.doorV(29, 5);
  windowsH(d, 2, 13, 1, 2, 4), windowsH(d, 30, 41, 10, 2, 4);
  for (const auto& [x, y] : {std::pair{4.5, 7.5},
                             {11.0, 7.5},
                             {12.5, 6.3},
                             {31.0, 6.3},
                             {33.0, 7.5},
                             {39.0, 7.5},
                             {39.0, 4.5},
                             {33.0, 4.5},
                             {31.0, 5.7},
                             {12.5, 5.7},
                             {11.0, 4.5},
                             {4.5, 4.5}})
    d.visit(x, y);
  return d.plan;
}

// Five storeys, each a ring of corridors round two rooms, with stairs from one to the next. The tour goes
// round each on the way up, and through its other half on the way down.
Plan towerPlan() {
  constexpr int kStoreys = 5, kPitch = 28, kRight = 21;
  constexpr double kWest = 2.5, kEast = 19.5, kSouth = 3.5, kNorth = 14.5;  // lanes of a ring
  Draughtsman d("tower", kStoreys * kPitch, 18);
  d.plan.storeys = kStoreys;
  for (int k = 0; k < kStoreys; ++k) {
    const int x = k * kPitch;
    d.fill(x, 1, x + kPitch - 1, 16, '#');
    d.fill(x + 1, 2, x + 20, 4, '.'), d.fill(x + 1, 13, x + 20, 15, '.');
    d.fill(x + 1, 5, x + 3, 12, '.'), d.fill(x + 18, 5, x + 20, 12, '.');
    d.fill(x + 5, 6, x + 10, 11, 'a'), d.fill(x + 12, 6, x + 16, 11, 'b');
    d.doorH(x + 7, 5), d.doorH(x + 13, 12);
    windowsH(d, x + 1, x + 20, 1, 2, 6), windowsH(d, x + 1, x + 20, 16, 2, 6);
    if (k > 0) d.fill(x, 2, x, 4, '+');
    if (k + 1 == kStoreys) continue;
    d.fill(x + kRight, 2, x + kRight, 4, '+');
    d.fill(x + kRight + 1, 2, x + kPitch - 1, 4, 's');
  }
  const auto visit = [&](int k, double x, double y) { d.visit(k * kPitch + x, y); };
  for (int k = 0; k < kStoreys; ++k) {
    visit(k, kWest, kSouth), visit(k, kEast, kSouth), visit(k, kEast, kNorth), visit(k, kWest, kNorth);
    visit(k, kWest, kSouth);
  }
  for (int k = kStoreys - 2; k >= 0; --k) {
    visit(k, kEast, kSouth), visit(k, kEast, kNorth), visit(k, kWest, kNorth);
    if (k > 0) visit(k, kWest, kSouth);
  }
  return d.plan;
}

}  // namespace

const std::vector<std::string>& presetNames() {
  static const std::vector<std::string> names{"tiny",  "office", "corridors", "campus",
                                              "loops", "rooms",  "tower"};
  return names;
}

Plan presetPlan(const std::string& preset, std::uint64_t seed) {
  const base::Rng rng = base::Rng(seed).fork(1);
  Plan plan;
  if (preset == "tiny")
    plan = tinyPlan();
  else if (preset == "office")
    plan = officePlan(rng);
  else if (preset == "corridors")
    plan = corridorsPlan(rng);
  else if (preset == "campus")
    plan = campusPlan(rng);
  else if (preset == "loops")
    plan = loopsPlan(rng);
  else if (preset == "rooms")
    plan = roomsPlan();
  else if (preset == "tower")
    plan = towerPlan();
  else
    throw base::Error("unknown preset '" + preset +
                      "'; use tiny, office, corridors, campus, loops, rooms or tower");
  return parsePlan(plan.toText(), "preset " + preset);  // holds the generator to the rules of the format
}

}  // namespace engram::world

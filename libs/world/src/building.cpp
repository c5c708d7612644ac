// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/building.h"

#include <cmath>
#include <numeric>
#include <set>

namespace engram::world {
namespace {

constexpr float kRouteClearance = 0.42f;  // [m] between furniture and the nominal route
constexpr float kDoorClearance = 0.7f;    // [m] free floor before a door
constexpr double kHouseWidth = 7.0;       // [m] along a street
constexpr float kStreetLamp = 4.5f;       // [m] above the street

bool overlap(const Eigen::Vector2f& low, const Eigen::Vector2f& high, const Eigen::Vector2f& low2,
             const Eigen::Vector2f& high2) {
  return (low.array() < high2.array()).all() && (low2.array() < high.array()).all();
}

}  // namespace

Eigen::Vector2f Furniture::half() const {
  Eigen::Vector2f size(0.3f, 0.3f);  // width along the front, depth
  switch (kind) {
    case FurnitureKind::kBookshelf:
      size = {1.0f, 0.34f};
      break;
    case FurnitureKind::kCabinet:
      size = {0.8f, 0.45f};
      break;
    case FurnitureKind::kDesk:
      size = {1.4f, 0.7f};
      break;
    case FurnitureKind::kTable:
      size = {1.2f, 0.8f};
      break;
    case FurnitureKind::kChair:
      size = {0.45f, 0.45f};
      break;
    case FurnitureKind::kBoxes:
      size = {0.5f, 0.4f};
      break;
    case FurnitureKind::kPlant:
      size = {0.5f, 0.5f};
      break;
    case FurnitureKind::kBin:
      size = {0.3f, 0.3f};
      break;
    case FurnitureKind::kSofa:
      size = {1.6f, 0.75f};
      break;
    case FurnitureKind::kRug:
      size = {1.8f, 1.2f};
      break;
  }
  return facing < 2 ? Eigen::Vector2f(size.y() / 2, size.x() / 2) : Eigen::Vector2f(size / 2);
}

Building::Building(const Plan& plan, std::uint64_t seed) : plan_(plan), seed_(seed) {
  const base::Rng rng = base::Rng(seed).fork(2);
  findRooms();
  findDoors();
  hangLamps();
  plan_.open ? buildFronts(rng.fork(4)) : screwFixtures(rng.fork(1));
  chooseSpots(rng.fork(2));
  furnish(rng.fork(3));
  posterModels_.resize(posterSpots_.size());
  std::iota(posterModels_.begin(), posterModels_.end(), 0);
  if (plan_.storeys > 1) repeatStoreys();
}

int Building::cellAt(float x, float y) const {
  const int cx = static_cast<int>(std::floor(x / static_cast<float>(plan_.cell)));
  const int cy = static_cast<int>(std::floor(y / static_cast<float>(plan_.cell)));
  return cx < 0 || cy < 0 || cx >= plan_.columns || cy >= plan_.rows ? -1 : cy * plan_.columns + cx;
}

void Building::findRooms() {
  roomOf_.assign(plan_.cells.size(), -1);
  base::Rng rng = base::Rng(seed_).fork(3);
  const int corridorStyle = static_cast<int>(rng.below(4));
  for (std::size_t start = 0; start < plan_.cells.size(); ++start) {
    if (!isFloor(plan_.cells[start]) || roomOf_[start] >= 0) continue;
    Room room;
    room.letter = plan_.cells[start];
    room.style = room.isCorridor() ? corridorStyle : 4 + static_cast<int>(rng.below(8));
    room.cells.push_back(static_cast<int>(start));
    roomOf_[start] = static_cast<int>(rooms_.size());
    for (std::size_t i = 0; i < room.cells.size(); ++i) {
      const int x = room.cells[i] % plan_.columns, y = room.cells[i] / plan_.columns;
      for (const auto& [dx, dy] : kSteps) {
        const int next = (y + dy) * plan_.columns + x + dx;
        if (plan_.at(x + dx, y + dy) != room.letter || roomOf_[static_cast<std::size_t>(next)] >= 0) continue;
        roomOf_[static_cast<std::size_t>(next)] = static_cast<int>(rooms_.size());
        room.cells.push_back(next);
      }
    }
    rooms_.push_back(std::move(room));
  }
}

void Building::findDoors() {
  const auto cell = static_cast<float>(plan_.cell);
  base::Rng rng = base::Rng(seed_).fork(4);
  const int usual = static_cast<int>(rng.below(4));  // most doors of a building look alike
  for (int y = 0; y < plan_.rows; ++y)
    for (int x = 0; x < plan_.columns; ++x) {
      if (plan_.at(x, y) != '+' || plan_.at(x - 1, y) == '+' || plan_.at(x, y - 1) == '+') continue;
      Door door;
      door.alongX = isFloor(plan_.at(x, y - 1)) && isFloor(plan_.at(x, y + 1));
      int n = 1;
      while (plan_.at(x + (door.alongX ? n : 0), y + (door.alongX ? 0 : n)) == '+') ++n;
      door.low = Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y)) * cell;
      door.high = door.low + Eigen::Vector2f(door.alongX ? n * cell : cell, door.alongX ? cell : n * cell);
      door.kind = rng.below(4) ? usual : static_cast<int>(rng.below(4));
      door.onRoute = distanceToRoute(door.low, door.high) < 0.2f;
      doors_.push_back(door);
    }
}

void Building::hangLamps() {
  const auto cell = static_cast<float>(plan_.cell),
             z = plan_.open ? kStreetLamp : static_cast<float>(plan_.height) - 0.01f;
  const int pitch = std::max(2, static_cast<int>((plan_.open ? 5.0 : 2.4) / plan_.cell));
  for (std::size_t r = 0; r < rooms_.size(); ++r) {
    const int phase = pitch / 2 + (rooms_[r].isCorridor() ? 0 : 1);
    const std::size_t first = lamps_.size();
    for (const int c : rooms_[r].cells) {
      const int x = c % plan_.columns, y = c / plan_.columns;
      if (x % pitch != phase % pitch || y % pitch != 1 % pitch) continue;
      lamps_.push_back({{(static_cast<float>(x) + 0.5f) * cell, (static_cast<float>(y) + 0.5f) * cell, z},
                        static_cast<int>(r)});
    }
    if (lamps_.size() > first)
      continue;  // a room between the grid lines gets one lamp in the middle of its cells
    const int c = rooms_[r].cells[rooms_[r].cells.size() / 2];
    lamps_.push_back({{(static_cast<float>(c % plan_.columns) + 0.5f) * cell,
                       (static_cast<float>(c / plan_.columns) + 0.5f) * cell, z},
                      static_cast<int>(r)});
  }
}

bool Building::tryWallSpot(int cell, int side, float offset, float width, float z0, float z1,
                           WallSpot& spot) const {
  const auto size = static_cast<float>(plan_.cell);
  const int dx = kSteps[side][0], dy = kSteps[side][1];
  const bool alongX = dx == 0;
  const int x = cell % plan_.columns, y = cell / plan_.columns;
  const int count = static_cast<int>(std::floor((offset + width) / size)) + 1;
  for (int i = 0; i < count; ++i) {
    const int cx = x + (alongX ? i : 0), cy = y + (alongX ? 0 : i);
    if (plan_.at(cx, cy) != plan_.at(x, y) || plan_.at(cx + dx, cy + dy) != '#') return false;
  }
  spot.cell = cell, spot.cells = count, spot.side = side;
  spot.a0 = static_cast<float>(alongX ? x : y) * size + offset;
  spot.a1 = spot.a0 + width;
  spot.z0 = z0, spot.z1 = z1;
  return !isTaken(spot);
}

bool Building::isTaken(const WallSpot& s) const {
  const auto line = [&](const WallSpot& w) {
    return w.side < 2 ? w.cell % plan_.columns : w.cell / plan_.columns;
  };
  for (const auto& o : taken_)
    if (o.side == s.side && line(o) == line(s) && s.a0 < o.a1 + 0.05f && o.a0 < s.a1 + 0.05f &&
        s.z0 < o.z1 + 0.03f && o.z0 < s.z1 + 0.03f)
      return true;
  return false;
}

void Building::screwFixtures(base::Rng rng) {
  WallSpot spot;
  std::uint32_t number = 101;
  const auto add = [&](Fixture kind, std::uint32_t look) {
    fixtures_.push_back({spot, kind, look});
    taken_.push_back(spot);
  };
  for (const auto& door : doors_) {  // frames of 6 cm round the opening, and a number beside it
    for (const int turn : {0, 1}) {
      const int side = door.alongX ? 2 + turn : turn;
      const int step = turn == 0 ? -1 : 1;  // the room lies on this side of the wall
      const auto cell = static_cast<float>(plan_.cell);
      const Eigen::Vector2f first = door.low + Eigen::Vector2f(cell, cell) * 0.5f;
      const int base = cellAt(first.x() + (door.alongX ? 0 : static_cast<float>(step) * cell),
                              first.y() + (door.alongX ? static_cast<float>(step) * cell : 0));
      const float a0 = door.alongX ? door.low.x() : door.low.y(),
                  a1 = door.alongX ? door.high.x() : door.high.y();
      const int stride = door.alongX ? 1 : plan_.columns;
      const int n = static_cast<int>(std::lround((a1 - a0) / cell));
      spot = {base, n, side, a0, a1, kDoorHeight, kDoorHeight + 0.07f};
      add(Fixture::kFrame, 0);
      spot = {base - stride, 1, side, a0 - 0.07f, a0, 0, kDoorHeight + 0.07f};
      add(Fixture::kFrame, 0);
      spot = {base + n * stride, 1, side, a1, a1 + 0.07f, 0, kDoorHeight + 0.07f};
      add(Fixture::kFrame, 0);
      if (tryWallSpot(base + n * stride, side, 0.12f, 0.24f, 1.5f, 1.62f, spot))
        add(Fixture::kDoorSign, number);
      if (tryWallSpot(base - stride, side, 0.25f, 0.09f, 1.05f, 1.14f, spot)) add(Fixture::kSmallThing, 0);
    }
    ++number;
  }
  for (std::size_t r = 0; r < rooms_.size(); ++r)
    for (const int cell : rooms_[r].cells)
      for (int side = 0; side < 4; ++side) {
        const auto dice = rng.below(100);
        const auto kind = rng.below(5);
        const float offset = static_cast<float>(rng.uniform(0, 0.3));
        if (dice < 4 && tryWallSpot(cell, side, offset, 1.5f, 1.1f, 1.85f, spot))
          add(Fixture::kNoticeBoard, kind * 100 + dice);
        if (dice >= 90) {
          static constexpr float widths[]{0.09f, 0.16f, 0.36f, 0.17f, 0.3f},
              lows[]{1.05f, 0.3f, 2.25f, 0.9f, 2.1f};
          static constexpr float heights[]{0.09f, 0.09f, 0.2f, 0.5f, 0.3f};
          if (tryWallSpot(cell, side, offset, widths[kind], lows[kind], lows[kind] + heights[kind], spot))
            add(Fixture::kSmallThing, kind);
        }
      }
}

std::uint32_t Building::houseAt(int cell, int side) const {
  const int x = cell % plan_.columns, y = cell / plan_.columns;
  const int along = side < 2 ? y : x, line = side < 2 ? x : y;
  const auto house = static_cast<std::uint64_t>(static_cast<int>(along * plan_.cell / kHouseWidth));
  const auto front = (static_cast<std::uint64_t>(line) * 4 + static_cast<std::uint64_t>(side)) << 16 | house;
  return static_cast<std::uint32_t>(base::Rng(seed_).fork(6).fork(front).bits());
}

/// What stands at the feet of the houses along a street: an entrance to each, shops, signs.
void Building::buildFronts(base::Rng rng) {
  std::set<std::uint32_t> entered;
  for (std::size_t r = 0; r < rooms_.size(); ++r)
    for (int side = 0; side < 4; ++side)
      for (const int cell : rooms_[r].cells) {
        const auto dice = rng.below(100), look = rng.below(1000);
        const float offset = static_cast<float>(rng.uniform(0, 0.4));
        const std::uint32_t house = houseAt(cell, side);
        WallSpot spot;
        const auto add = [&](Fixture kind) {
          fixtures_.push_back({spot, kind, look});
          taken_.push_back(spot);
        };
        if (entered.count(house) == 0 && tryWallSpot(cell, side, 0.4f + offset, 1.1f, 0, 2.3f, spot)) {
          entered.insert(house);
          add(Fixture::kEntrance);
        } else if (dice < 12 && tryWallSpot(cell, side, offset, 2.2f, 0.4f, 2.5f, spot)) {
          add(Fixture::kShopFront);
        } else if (dice < 16 && tryWallSpot(cell, side, offset, 1.5f, 1.1f, 1.85f, spot)) {
          add(Fixture::kNoticeBoard);
        } else if (dice >= 90 && tryWallSpot(cell, side, offset, 0.24f, 2.4f, 2.52f, spot)) {
          add(Fixture::kDoorSign);
        }
      }
}

void Building::chooseSpots(base::Rng rng) {
  for (std::size_t r = 0; r < rooms_.size(); ++r)
    for (const int cell : rooms_[r].cells)
      for (int side = 0; side < 4; ++side) {
        const bool wanted = rng.below(100) < (plan_.open ? 8u : rooms_[r].isCorridor() ? 34u : 26u);
        const float offset = static_cast<float>(rng.uniform(0, 0.45)),
                    width = static_cast<float>(rng.uniform(0.42, 0.85));
        const float low = static_cast<float>(rng.uniform(0.95, 1.25));
        WallSpot spot;
        if (!wanted || !tryWallSpot(cell, side, offset, width, low, low + width * 1.33f, spot)) continue;
        posterSpots_.push_back(spot);
        taken_.push_back(spot);
      }
}

float Building::distanceToRoute(const Eigen::Vector2f& low, const Eigen::Vector2f& high) const {
  float best = 1e9f;
  for (std::size_t i = 0; i < plan_.route.size(); ++i) {
    const Eigen::Vector2f a = plan_.route[i].cast<float>(),
                          b = plan_.route[(i + 1) % plan_.route.size()].cast<float>();
    const int steps = 1 + static_cast<int>((b - a).norm() / 0.1f);
    for (int s = 0; s <= steps; ++s) {
      const Eigen::Vector2f p = a + (b - a) * (static_cast<float>(s) / static_cast<float>(steps));
      best = std::min(best, (p - p.cwiseMax(low).cwiseMin(high)).norm());
    }
  }
  return best;
}

bool Building::fits(const Furniture& piece, const std::vector<Furniture>& others, int self) const {
  const Eigen::Vector2f low = piece.centre - piece.half(), high = piece.centre + piece.half();
  const auto cell = static_cast<float>(plan_.cell);
  for (float y = low.y() + 0.01f;; y = std::min(y + cell, high.y() - 0.01f)) {
    for (float x = low.x() + 0.01f;; x = std::min(x + cell, high.x() - 0.01f)) {
      const int c = cellAt(x, y);
      if (c < 0 || roomOf(c) != piece.room) return false;
      if (x >= high.x() - 0.011f) break;
    }
    if (y >= high.y() - 0.011f) break;
  }
  if (piece.kind == FurnitureKind::kRug) {
    for (std::size_t i = 0; i < others.size(); ++i) {
      const auto& o = others[i];
      if (static_cast<int>(i) != self && o.kind == FurnitureKind::kRug &&
          overlap(low, high, o.centre - o.half(), o.centre + o.half()))
        return false;
    }
    return true;
  }
  if (distanceToRoute(low, high) < kRouteClearance) return false;
  const Eigen::Vector2f margin(kDoorClearance, kDoorClearance);
  for (const auto& d : doors_)
    if (overlap(low, high, d.low - margin, d.high + margin)) return false;
  const Eigen::Vector2f gap(0.03f, 0.03f);
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto& o = others[i];
    if (static_cast<int>(i) != self && o.kind != FurnitureKind::kRug && o.room == piece.room &&
        overlap(low - gap, high + gap, o.centre - o.half(), o.centre + o.half()))
      return false;
  }
  return true;
}

bool Building::place(Furniture& piece, const std::vector<Furniture>& others, int self, base::Rng& rng) const {
  const auto& cells = rooms_[static_cast<std::size_t>(piece.room)].cells;
  const auto size = static_cast<float>(plan_.cell);
  const bool free = piece.kind == FurnitureKind::kTable || piece.kind == FurnitureKind::kRug ||
                    piece.kind == FurnitureKind::kChair;
  const bool tall = piece.kind == FurnitureKind::kBookshelf || piece.kind == FurnitureKind::kCabinet;
  for (int attempt = 0; attempt < 60; ++attempt) {
    const int c = cells[rng.below(static_cast<std::uint32_t>(cells.size()))];
    const int x = c % plan_.columns, y = c / plan_.columns, side = static_cast<int>(rng.below(4));
    Furniture trial = piece;
    trial.facing = side ^ 1;
    trial.centre = {(static_cast<float>(x) + static_cast<float>(rng.uniform())) * size,
                    (static_cast<float>(y) + static_cast<float>(rng.uniform())) * size};
    if (!free) {  // back to a wall
      const char wall = plan_.at(x + kSteps[side][0], y + kSteps[side][1]);
      if (wall != '#' && (wall != '=' || tall)) continue;
      const int axis = side / 2;
      const float face = static_cast<float>((axis == 0 ? x : y) + (side % 2 == 0 ? 1 : 0)) * size;
      trial.centre[axis] = face + (side % 2 == 0 ? -1.0f : 1.0f) * (trial.half()[axis] + 0.01f);
    }
    if (!fits(trial, others, self)) continue;
    piece = trial;
    return true;
  }
  return false;
}

void Building::furnish(base::Rng rng) {
  using K = FurnitureKind;
  const std::vector<K> office{K::kRug,   K::kDesk,  K::kBookshelf, K::kCabinet,   K::kDesk, K::kChair,
                              K::kTable, K::kPlant, K::kChair,     K::kBookshelf, K::kBin,  K::kBoxes};
  const std::vector<K> corridor{K::kCabinet, K::kPlant, K::kBoxes, K::kBookshelf, K::kBin, K::kSofa};
  const std::vector<K> street{K::kPlant, K::kBin, K::kPlant, K::kBoxes, K::kTable, K::kPlant, K::kCabinet};
  for (std::size_t r = 0; r < rooms_.size(); ++r) {
    const double area = static_cast<double>(rooms_[r].cells.size()) * plan_.cell * plan_.cell;
    const auto& kinds = plan_.open ? street : rooms_[r].isCorridor() ? corridor : office;
    const int count = static_cast<int>(area * (plan_.open ? 0.1 : rooms_[r].isCorridor() ? 0.25 : 0.8));
    const auto shift = rooms_[r].isCorridor() ? rng.below(static_cast<std::uint32_t>(kinds.size())) : 0u;
    for (int i = 0; i < std::min(count, 30); ++i) {
      Furniture piece;
      piece.kind = kinds[(static_cast<std::size_t>(i) + shift) % kinds.size()];
      piece.room = static_cast<int>(r);
      piece.look = rng.below(4);  // few looks: the same shelf stands in many places
      if (place(piece, furniture_, -1, rng)) furniture_.push_back(piece);
    }
  }
}

}  // namespace engram::world

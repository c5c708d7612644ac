// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "engram/world/plan.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace engram::world {

/// Directions, and sides of a cell: +x, -x, +y, -y, +z, -z.
inline constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
inline constexpr float kDoorHeight = 2.05f, kSill = 0.9f, kWindowHead = 2.2f;  // [m]

struct Room {
  char letter = '.';
  std::vector<int> cells;  ///< indices of its floor cells
  int style = 0;           ///< walls and floor
  bool isCorridor() const { return letter == '.'; }
};

struct Door {
  Eigen::Vector2f low, high;  ///< opening on the floor [m]
  bool alongX = true;         ///< the wall runs along x
  int kind = 0;               ///< look of the leaf
  bool onRoute = false;       ///< never closed
};

/// A rectangle on a wall, seen from the cells of one room.
struct WallSpot {
  int cell = 0;          ///< first floor cell along it
  int cells = 1;         ///< number of cells that it touches
  int side = 0;          ///< side of the cell, index of kSteps
  float a0 = 0, a1 = 0;  ///< along the wall: x or y [m]
  float z0 = 0, z1 = 0;  ///< [m]
};

enum class Fixture : std::uint8_t { kNoticeBoard, kDoorSign, kSmallThing, kFrame, kEntrance, kShopFront };
struct FixedSpot {
  WallSpot spot;
  Fixture kind = Fixture::kSmallThing;
  std::uint32_t look = 0;  ///< seed, number or kind of its look
};

struct Lamp {
  Eigen::Vector3f position;  ///< centre of the panel [m]
  int room = 0;
};

enum class FurnitureKind : std::uint8_t {
  kBookshelf,
  kCabinet,
  kDesk,
  kTable,
  kChair,
  kBoxes,
  kPlant,
  kBin,
  kSofa,
  kRug
};
struct Furniture {
  FurnitureKind kind = FurnitureKind::kBoxes;
  int room = 0;
  Eigen::Vector2f centre;  ///< [m]
  int facing = 0;          ///< direction of its front, index of kSteps
  std::uint32_t look = 0;
  Eigen::Vector2f half() const;  ///< half extent along x and y [m]
};

/// Everything about a building that does not change: its plan, rooms, doors, lamps, the spots for posters and
/// what is screwed to the walls. The same plan and seed give the same building.
class Building {
 public:
  Building(const Plan& plan, std::uint64_t seed);

  const Plan& plan() const { return plan_; }
  std::uint64_t seed() const { return seed_; }
  const std::vector<Room>& rooms() const { return rooms_; }
  const std::vector<Door>& doors() const { return doors_; }
  const std::vector<Lamp>& lamps() const { return lamps_; }
  const std::vector<WallSpot>& posterSpots() const { return posterSpots_; }
  /// The spot at the same place of the storey that all others are like, for each of posterSpots(); without
  /// storeys each is its own.
  const std::vector<int>& posterModels() const { return posterModels_; }
  const std::vector<FixedSpot>& fixtures() const { return fixtures_; }
  /// Number that tells houses along a street apart: of the house that stands beside a floor cell in direction
  /// `side`. Without an order; the same for a whole front.
  std::uint32_t houseAt(int cell, int side) const;
  /// As on the day of opening.
  const std::vector<Furniture>& furniture() const { return furniture_; }
  /// Room of a floor cell, -1 elsewhere.
  int roomOf(int cell) const { return roomOf_[static_cast<std::size_t>(cell)]; }
  int cellAt(float x, float y) const;

  /// True when the piece stands within its room, off the route, the doors and every other piece but `self`.
  bool fits(const Furniture& piece, const std::vector<Furniture>& others, int self) const;
  /// Tries to find a place for a piece in its room; false when there is none.
  bool place(Furniture& piece, const std::vector<Furniture>& others, int self, base::Rng& rng) const;

 private:
  void findRooms();
  void findDoors();
  void hangLamps();
  void screwFixtures(base::Rng rng);
  void buildFronts(base::Rng rng);
  void chooseSpots(base::Rng rng);
  void furnish(base::Rng rng);
  bool tryWallSpot(int cell, int side, float offset, float width, float z0, float z1, WallSpot& spot) const;
  bool isTaken(const WallSpot& spot) const;
  void repeatStoreys();
  float distanceToRoute(const Eigen::Vector2f& low, const Eigen::Vector2f& high) const;

  Plan plan_;
  std::uint64_t seed_;
  std::vector<Room> rooms_;
  std::vector<int> roomOf_;
  std::vector<Door> doors_;
  std::vector<Lamp> lamps_;
  std::vector<WallSpot> posterSpots_, taken_;
  std::vector<int> posterModels_;
  std::vector<FixedSpot> fixtures_;
  std::vector<Furniture> furniture_;
};

}  // namespace engram::world

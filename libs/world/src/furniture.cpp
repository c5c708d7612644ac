// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/scene.h"

namespace engram::world {
namespace {

// Builds boxes in the frame of a piece: a along the width, b from back (0) to front, z up.
class Carpenter {
 public:
  Carpenter(const Furniture& piece, std::vector<Box>& boxes) : piece_(piece), boxes_(boxes) {
    const Eigen::Vector2f half = piece.half();
    width_ = 2 * (piece.facing < 2 ? half.y() : half.x());
    depth_ = 2 * (piece.facing < 2 ? half.x() : half.y());
  }
  float width() const { return width_; }
  float depth() const { return depth_; }

  Box& add(float a0, float a1, float b0, float b1, float z0, float z1, int body, int front = -1,
           int facing = -1) {
    const int axis = piece_.facing / 2;                        // axis of depth
    const float sign = piece_.facing % 2 == 0 ? 1.0f : -1.0f;  // depth grows along the axis or against it
    Box box;
    const float c = piece_.centre[axis], w = piece_.centre[1 - axis];
    const float d0 = c + sign * (b0 - depth_ / 2), d1 = c + sign * (b1 - depth_ / 2);
    box.low[axis] = std::min(d0, d1), box.high[axis] = std::max(d0, d1);
    box.low[1 - axis] = w - width_ / 2 + a0, box.high[1 - axis] = w - width_ / 2 + a1;
    box.low[2] = z0, box.high[2] = z1;
    box.body = body, box.front = front;
    box.facing = facing >= 0 ? facing : piece_.facing;
    boxes_.push_back(box);
    return boxes_.back();
  }
  void legs(float height, int texture) {
    constexpr float t = 0.05f;
    for (const float a : {0.03f, width_ - 0.03f - t})
      for (const float b : {0.03f, depth_ - 0.03f - t}) add(a, a + t, b, b + t, 0, height, texture);
  }

 private:
  const Furniture& piece_;
  std::vector<Box>& boxes_;
  float width_, depth_;
};

void buildDesk(Carpenter& c, const Library& lib, int wood, std::uint32_t look) {
  c.add(0, c.width(), 0, c.depth(), 0.70f, 0.74f, wood);
  c.add(0, 0.04f, 0.05f, c.depth() - 0.05f, 0, 0.70f, wood);
  c.add(c.width() - 0.45f, c.width() - 0.02f, 0.08f, c.depth() - 0.05f, 0.1f, 0.70f, lib.metal,
        lib.cabinets[look]);
  c.add(0.35f, 0.9f, 0.2f, 0.24f, 0.86f, 1.2f, lib.metal, lib.screen);
  c.add(0.56f, 0.68f, 0.2f, 0.3f, 0.74f, 0.86f, lib.metal);
  c.add(0.4f, 0.85f, 0.42f, 0.56f, 0.74f, 0.76f, lib.metal);
  c.add(1.02f, 1.25f, 0.25f, 0.5f, 0.74f, 0.74f + 0.04f * static_cast<float>(look + 1), lib.white,
        lib.posters[look % lib.posters.size()], 4);
}

}  // namespace

void addFurniture(const Furniture& piece, const Library& lib, std::vector<Box>& boxes,
                  std::vector<Pillar>& plants) {
  Carpenter c(piece, boxes);
  const auto look = piece.look % 4;
  const int wood = lib.woods[look], cloth = lib.fabrics[look];
  const float w = c.width(), d = c.depth();
  switch (piece.kind) {
    case FurnitureKind::kBookshelf:
      c.add(0, w, 0, d, 0, 2.0f, wood, lib.shelves[look]);
      break;
    case FurnitureKind::kCabinet:
      c.add(0, w, 0, d, 0, 1.25f, lib.white, lib.cabinets[look]);
      break;
    case FurnitureKind::kDesk:
      buildDesk(c, lib, wood, look);
      break;
    case FurnitureKind::kTable:
      c.add(0, w, 0, d, 0.71f, 0.75f, wood);
      c.legs(0.71f, lib.metal);
      c.add(w * 0.3f, w * 0.3f + 0.3f, d * 0.3f, d * 0.3f + 0.22f, 0.75f, 0.77f, lib.white,
            lib.posters[(look + 5) % lib.posters.size()], 4);
      break;
    case FurnitureKind::kChair:
      c.add(0, w, 0, d, 0.42f, 0.47f, cloth);
      c.add(0, w, 0, 0.05f, 0.5f, 0.92f, cloth);
      c.legs(0.42f, lib.metal);
      break;
    case FurnitureKind::kBoxes:
      c.add(0, w, 0, d, 0, 0.38f, lib.cartons[look], lib.cartons[look]);
      if (look > 0)
        c.add(0.04f, w - 0.06f, 0.03f, d - 0.02f, 0.38f, 0.7f, lib.cartons[(look + 1) % 4],
              lib.cartons[(look + 1) % 4]);
      break;
    case FurnitureKind::kPlant:
      plants.push_back({piece.centre, 1.1f + 0.15f * static_cast<float>(look),
                        0.5f * static_cast<float>(look), 0, lib.foliage, true});
      break;
    case FurnitureKind::kBin:
      c.add(0, w, 0, d, 0, 0.55f, lib.metal, lib.smallThings[5]);
      break;
    case FurnitureKind::kSofa:
      c.add(0, w, 0, d, 0.05f, 0.42f, cloth);
      c.add(0, w, 0, 0.18f, 0.42f, 0.8f, cloth);
      c.add(0, 0.15f, 0, d, 0.42f, 0.6f, cloth);
      c.add(w - 0.15f, w, 0, d, 0.42f, 0.6f, cloth);
      break;
    case FurnitureKind::kRug:
      c.add(0, w, 0, d, 0, 0.012f, cloth, lib.rugs[look], 4);
      break;
  }
}

}  // namespace engram::world

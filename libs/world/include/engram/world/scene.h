// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/world/building.h"
#include "engram/world/library.h"
#include "engram/world/schedule.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::world {

/// An axis-aligned block with textures.
struct Box {
  Eigen::Array3f low, high;  ///< [m]
  int body = 0;              ///< texture of the faces, one repetition a metre
  int front = -1;            ///< texture stretched over the face in direction `facing`; -1: as the others
  int facing = 0;            ///< index of kSteps, 4 top, 5 bottom
  bool bothSides = false;    ///< the opposite face has the front texture too
  float glow = 0;            ///< radiance of the front by itself; 0: lit by the room
};

/// Something round and upright: a person or a plant. Drawn as its silhouette, turned to the camera.
struct Pillar {
  Eigen::Vector2f centre;  ///< [m]
  float height = 1.75f;    ///< [m]
  float heading = 0;       ///< [rad]
  float stride = 0;        ///< legs apart, -1 … 1
  int texture = 0;
  bool plant = false;
};

/// What a ray meets first.
struct Hit {
  enum class Kind : std::uint8_t { kOutside, kFloor, kCeiling, kWall, kBox };
  Kind kind = Kind::kOutside;
  float t = 0;   ///< in units of the direction's length
  int cell = 0;  ///< the cell from which it is seen
  int side = 0;  ///< direction against the surface normal: index of kSteps, 4 up, 5 down
  int box = -1;
};

/// A building in one session as the ray caster needs it: a grid of cells with heights, rectangles on walls,
/// boxes, and light stored in a volume. Immutable after construction; safe to read from many threads.
class Scene {
 public:
  Scene(const Building& building, const Appearance& appearance, const Library& library, int threads = 1);

  /// First surface along a ray that starts inside the building [m]; `limit` bounds t.
  Hit trace(const Eigen::Array3f& origin, const Eigen::Array3f& direction, float limit = 1e6f) const;

  /// Light that comes to `origin` against a unit `direction`.
  /// @param footprint angle of the pixel [rad]
  /// @param dither in [0, 1): added to the mipmap level before it is cut off, so that several samples blend
  /// levels
  Colour radiance(const Eigen::Array3f& origin, const Eigen::Array3f& direction, float footprint,
                  float dither, std::span<const Pillar> people) const;

  /// Irradiance of a surface at p whose normal is direction `normal` (0 … 5: +x, -x, +y, -y, +z, -z).
  Colour irradiance(const Eigen::Array3f& p, int normal) const;

  const Library& library() const { return library_; }
  const std::vector<Box>& boxes() const { return boxes_; }

 private:
  struct Decal {
    float a0, a1, z0, z1;  // along the wall, up [m]
    int texture;
    bool flip;  // u runs against the axis
  };
  struct Range {
    int first = 0, count = 0;
  };
  struct Cell {
    float floor = 0, ceiling = 0;  // free space [m]; a wall has none
    bool solid = true, outside = false, sunny = false;
    int wall = 0, floorTexture = 0;
    float wallScale = 0.5f, floorScale = 0.5f;
    std::array<Range, 4> decals;
    Range boxes;
  };

  // scene_build.cpp
  void buildCells();
  void buildStreets();
  void hangPictures();
  void addDecal(const WallSpot& spot, int texture);
  void buildDoors();
  void buildWindows();
  void buildLamps();
  void indexBoxes();
  void buildShade();
  // scene_light.cpp
  void bakeLight(int threads);
  void bakeCell(int x, int y, const std::vector<Eigen::Array3f>& panes);
  void addSky(int x, int y);
  void scatter();
  void fillSolid();
  void findSun();
  bool visible(const Eigen::Array3f& from, const Eigen::Array3f& to) const;
  bool sunlit(const Eigen::Array3f& p) const;
  std::size_t lightIndex(int normal, int z, int y, int x) const {
    return ((static_cast<std::size_t>(normal) * kLevels + z) * rows_ + y) * columns_ + x;
  }
  // scene_trace.cpp
  void hitBoxes(const Cell& cell, const Eigen::Array3f& o, const Eigen::Array3f& inverse, float until,
                Hit& hit) const;
  Colour surface(const Hit& hit, const Eigen::Array3f& p, float texels, float dither, float& glow) const;
  Colour wallColour(const Hit& hit, const Eigen::Array3f& p, float metres, float dither) const;
  Colour boxColour(const Hit& hit, const Eigen::Array3f& p, float metres, float dither, float& glow) const;
  Colour skyColour(const Eigen::Array3f& origin, const Eigen::Array3f& direction, float footprint,
                   float dither) const;
  bool pillarColour(const Pillar& pillar, const Eigen::Array3f& o, const Eigen::Array3f& d, float footprint,
                    float dither, float& t, Colour& out) const;
  float shadeAt(float x, float y) const;

  static constexpr int kLevels = 6;  // of the light volume, from floor to ceiling
  static constexpr int kFine = 5;    // shade samples a cell side

  const Building& building_;
  const Appearance& appearance_;
  const Library& library_;
  int columns_, rows_;
  float size_, height_;
  bool open_;  // no ceilings
  float far_;  // distance of the scenery outside [m]
  std::vector<Cell> cells_;
  std::vector<std::vector<Decal>> faceDecals_;  // by cell * 4 + side, while building
  std::vector<Decal> decals_;
  std::vector<Box> boxes_;
  std::vector<Pillar> plants_;
  std::vector<int> boxIndex_;
  std::vector<Colour> light_;
  std::vector<float> shade_;
};

/// The boxes of a piece of furniture; plants go to `plants`.
void addFurniture(const Furniture& piece, const Library& library, std::vector<Box>& boxes,
                  std::vector<Pillar>& plants);

}  // namespace engram::world

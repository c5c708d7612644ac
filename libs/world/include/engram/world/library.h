// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/world/building.h"
#include "engram/world/texture.h"

#include <string>
#include <vector>

namespace engram::world {

/// The textures of a building. Painted from its seed; shared by all sessions.
struct Library {
  /// @param photographs folder with images that hang as posters instead of the painted ones (at most 200, in
  /// order of
  ///        their names); empty: painted ones. Throws base::Error when it holds no readable image.
  Library(const Building& building, const std::string& photographs);

  TextureAtlas atlas;
  struct Style {
    int wall = 0, floor = 0;
    float wallScale = 0.5f, floorScale = 0.5f;  ///< repetitions per metre
  };
  std::vector<Style> styles;  ///< by Room::style
  std::vector<int> doors, posters, boards, signs, smallThings, shelves, cabinets, cartons, woods, fabrics,
      rugs, people,
      outside;                               ///< outside by season
  std::vector<int> facades, streets, shops;  ///< of plans without a roof; empty for others
  static constexpr float kFacadeScale = 0.25f, kStreetScale = 0.25f;  ///< repetitions per metre
  int ceiling = 0, radiator = 0, lamp = 0, screen = 0, foliage = 0, grime = 0, white = 0, metal = 0;
};

}  // namespace engram::world

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/scene.h"

#include <cmath>

namespace engram::world {
namespace {

constexpr float kFar = 30.0f;  // [m] distance of the scenery outside of a building

}  // namespace

Scene::Scene(const Building& building, const Appearance& appearance, const Library& library, int threads)
    : building_(building),
      appearance_(appearance),
      library_(library),
      columns_(building.plan().columns),
      rows_(building.plan().rows),
      size_(static_cast<float>(building.plan().cell)),
      height_(static_cast<float>(building.plan().height)),
      open_(building.plan().open),
      far_(open_ ? std::max(kFar, std::hypot(size_ * static_cast<float>(columns_),
                                             size_ * static_cast<float>(rows_)))
                 : kFar) {
  buildCells();
  if (open_) buildStreets();
  hangPictures();
  buildDoors();
  buildWindows();
  buildLamps();
  for (const auto& piece : appearance_.furniture) addFurniture(piece, library_, boxes_, plants_);
  indexBoxes();
  buildShade();
  bakeLight(threads);
}

void Scene::buildCells() {
  const Plan& plan = building_.plan();
  cells_.resize(plan.cells.size());
  faceDecals_.resize(cells_.size() * 4);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cell& c = cells_[i];
    const char mark = plan.cells[i];
    c.outside = mark == ' ';
    c.solid = mark == '#';
    c.ceiling = c.outside ? 1e9f : height_;
    if (c.outside) c.floor = -1e9f;
    c.wall = library_.white, c.floorTexture = library_.white;
    if (const int room = building_.roomOf(static_cast<int>(i)); room >= 0) {
      const auto& style =
          library_.styles[static_cast<std::size_t>(building_.rooms()[static_cast<std::size_t>(room)].style)];
      c.wall = style.wall, c.wallScale = style.wallScale;
      c.floorTexture = style.floor, c.floorScale = style.floorScale;
    } else if (mark == '+') {
      c.ceiling = kDoorHeight;
      c.floorTexture = library_.woods[0];
    } else if (mark == '=') {
      c.floor = kSill, c.ceiling = kWindowHead;
    }
  }
}

/// Every cell beside a house shows that house's front.
void Scene::buildStreets() {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cell& c = cells_[i];
    const int cell = static_cast<int>(i), room = building_.roomOf(cell);
    if (room < 0) continue;
    c.floorTexture = library_.streets[static_cast<std::size_t>(room) % library_.streets.size()];
    c.floorScale = Library::kStreetScale;
    c.wallScale = Library::kFacadeScale;
    for (int side = 0; side < 4; ++side) {
      const int x = cell % columns_ + kSteps[side][0], y = cell / columns_ + kSteps[side][1];
      if (building_.plan().at(x, y) == '#')
        c.wall = library_.facades[building_.houseAt(cell, side) % library_.facades.size()];
    }
  }
}

void Scene::addDecal(const WallSpot& spot, int texture) {
  const int stride = spot.side < 2 ? columns_ : 1;
  for (int i = 0; i < spot.cells; ++i) {
    const auto face = static_cast<std::size_t>((spot.cell + i * stride) * 4 + spot.side);
    if (face < faceDecals_.size())
      faceDecals_[face].push_back(
          {spot.a0, spot.a1, spot.z0, spot.z1, texture, spot.side == 0 || spot.side == 3});
  }
}

void Scene::hangPictures() {
  for (const auto& f : building_.fixtures()) {
    switch (f.kind) {
      case Fixture::kNoticeBoard:
        addDecal(f.spot, library_.boards[f.look % library_.boards.size()]);
        break;
      case Fixture::kDoorSign:
        addDecal(f.spot, library_.signs[(f.look - 101) % library_.signs.size()]);
        break;
      case Fixture::kSmallThing:
        addDecal(f.spot, library_.smallThings[f.look % library_.smallThings.size()]);
        break;
      case Fixture::kFrame:
        addDecal(f.spot, library_.metal);
        break;
      case Fixture::kEntrance:
        addDecal(f.spot, library_.doors[f.look % library_.doors.size()]);
        break;
      case Fixture::kShopFront:
        addDecal(f.spot, library_.shops[f.look % library_.shops.size()]);
        break;
    }
  }
  for (std::size_t i = 0; i < building_.posterSpots().size(); ++i)
    addDecal(building_.posterSpots()[i], library_.posters[appearance_.posters[i] % library_.posters.size()]);
  for (std::size_t i = 0; i < cells_.size(); ++i)
    for (std::size_t s = 0; s < 4; ++s) {
      auto& list = faceDecals_[i * 4 + s];
      cells_[i].decals[s] = {static_cast<int>(decals_.size()), static_cast<int>(list.size())};
      decals_.insert(decals_.end(), list.begin(), list.end());
    }
  faceDecals_.clear();
}

void Scene::buildDoors() {
  constexpr float thick = 0.04f;
  for (std::size_t i = 0; i < building_.doors().size(); ++i) {
    const Door& door = building_.doors()[i];
    const int along = door.alongX ? 0 : 1, across = 1 - along;
    Box leaf;
    leaf.body = library_.woods[0];
    leaf.front = library_.doors[static_cast<std::size_t>(door.kind)];
    leaf.bothSides = true;
    leaf.low[2] = 0.005f, leaf.high[2] = kDoorHeight - 0.01f;
    if (!appearance_.doorOpen[i]) {
      const float middle = (door.low[across] + door.high[across]) / 2;
      leaf.low[along] = door.low[along], leaf.high[along] = door.high[along];
      leaf.low[across] = middle - thick / 2, leaf.high[across] = middle + thick / 2;
      leaf.facing = 2 * across;
    } else {  // at a right angle in the room, not in the corridor
      const int step = along == 0 ? columns_ : 1;
      const int cell = building_.cellAt(door.low.x() + size_ / 2, door.low.y() + size_ / 2);
      const bool up = building_.plan().cells[static_cast<std::size_t>(cell + step)] != '.';
      const float width = door.high[along] - door.low[along];
      leaf.low[along] = door.low[along] - thick, leaf.high[along] = door.low[along];
      leaf.low[across] = up ? door.high[across] : door.low[across] - width;
      leaf.high[across] = leaf.low[across] + width;
      leaf.facing = 2 * along;
    }
    boxes_.push_back(leaf);
  }
}

void Scene::buildWindows() {
  constexpr float bar = 0.03f;
  const Plan& plan = building_.plan();
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      if (plan.at(x, y) != '=') continue;
      const int along = isFloor(plan.at(x, y - 1)) || isFloor(plan.at(x, y + 1)) ? 0 : 1;
      const Eigen::Array2f low(static_cast<float>(x) * size_, static_cast<float>(y) * size_);
      const auto add = [&](float a0, float a1, float z0, float z1) {
        Box b;
        b.body = library_.white;
        b.low[along] = low[along] + a0, b.high[along] = low[along] + a1;
        b.low[1 - along] = low[1 - along] + size_ / 2 - bar,
                  b.high[1 - along] = low[1 - along] + size_ / 2 + bar;
        b.low[2] = z0, b.high[2] = z1;
        boxes_.push_back(b);
      };
      add(0, size_, kSill, kSill + 2 * bar);
      add(0, size_, kWindowHead - 2 * bar, kWindowHead);
      add(0, bar, kSill, kWindowHead);
      add(size_ - bar, size_, kSill, kWindowHead);
      const int dx = along == 0 ? 0 : (isFloor(plan.at(x + 1, y)) ? 1 : -1);
      const int dy = along == 1 ? 0 : (isFloor(plan.at(x, y + 1)) ? 1 : -1);
      Box heater;  // below the sill, on the room's side
      heater.body = library_.white, heater.front = library_.radiator;
      const int across = 1 - along;
      const int inward = across == 0 ? dx : dy;
      heater.facing = 2 * across + (inward > 0 ? 0 : 1);
      heater.low[along] = low[along] + 0.02f, heater.high[along] = low[along] + size_ - 0.02f;
      const float face = low[across] + (inward > 0 ? size_ : 0);
      heater.low[across] = inward > 0 ? face : face - 0.1f;
      heater.high[across] = heater.low[across] + 0.1f;
      heater.low[2] = 0.15f, heater.high[2] = 0.75f;
      boxes_.push_back(heater);
    }
}

void Scene::buildLamps() {
  for (std::size_t i = 0; i < building_.lamps().size(); ++i) {
    const Eigen::Array3f p = building_.lamps()[i].position.array();
    Box b;
    b.low = p - Eigen::Array3f(0.29f, 0.29f, 0.03f), b.high = p + Eigen::Array3f(0.29f, 0.29f, 0.01f);
    b.body = library_.white, b.front = library_.lamp, b.facing = 5;
    b.glow = appearance_.lampOn[i] ? 6.0f : 0.0f;
    boxes_.push_back(b);
  }
}

void Scene::indexBoxes() {
  std::vector<std::vector<int>> lists(cells_.size());
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const Box& b = boxes_[i];
    const int x0 = std::max(0, static_cast<int>(b.low[0] / size_)),
              x1 = std::min(columns_ - 1, static_cast<int>(b.high[0] / size_));
    const int y0 = std::max(0, static_cast<int>(b.low[1] / size_)),
              y1 = std::min(rows_ - 1, static_cast<int>(b.high[1] / size_));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        lists[static_cast<std::size_t>(y * columns_ + x)].push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i].boxes = {static_cast<int>(boxIndex_.size()), static_cast<int>(lists[i].size())};
    boxIndex_.insert(boxIndex_.end(), lists[i].begin(), lists[i].end());
  }
}

// How much of the light reaches the floor: less beside walls and furniture. A blurred map of what stands on
// it.
void Scene::buildShade() {
  const int w = columns_ * kFine, h = rows_ * kFine;
  const float step = size_ / kFine;
  std::vector<float> blocked(static_cast<std::size_t>(w) * h, 0.0f);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (cells_[static_cast<std::size_t>(y / kFine * columns_ + x / kFine)].floor > 0 ||
          cells_[static_cast<std::size_t>(y / kFine * columns_ + x / kFine)].solid)
        blocked[static_cast<std::size_t>(y * w + x)] = 0.7f;
  const auto mark = [&](float x0, float y0, float x1, float y1, float value) {
    for (int y = std::max(0, static_cast<int>(y0 / step)); y <= std::min(h - 1, static_cast<int>(y1 / step));
         ++y)
      for (int x = std::max(0, static_cast<int>(x0 / step));
           x <= std::min(w - 1, static_cast<int>(x1 / step)); ++x)
        blocked[static_cast<std::size_t>(y * w + x)] =
            std::max(blocked[static_cast<std::size_t>(y * w + x)], value);
  };
  for (const auto& b : boxes_)
    if (b.high[2] > 0.05f && b.low[2] < 0.8f)
      mark(b.low[0], b.low[1], b.high[0], b.high[1], b.low[2] < 0.3f ? 0.95f : 0.6f);
  for (const auto& p : plants_)
    mark(p.centre.x() - 0.2f, p.centre.y() - 0.2f, p.centre.x() + 0.2f, p.centre.y() + 0.2f, 0.8f);
  std::vector<float> other(blocked.size());
  for (int pass = 0; pass < 4; ++pass) {  // two box blurs of 3 samples along each axis
    const int stride = pass % 2 ? w : 1;
    for (std::size_t i = 0; i < blocked.size(); ++i) {
      const std::size_t before =
          i >= static_cast<std::size_t>(stride) ? i - static_cast<std::size_t>(stride) : i;
      const std::size_t after = std::min(blocked.size() - 1, i + static_cast<std::size_t>(stride));
      other[i] = (blocked[before] + blocked[i] + blocked[after]) / 3;
    }
    blocked.swap(other);
  }
  shade_.resize(blocked.size());
  for (std::size_t i = 0; i < blocked.size(); ++i) shade_[i] = 1.0f - 0.75f * blocked[i];
}

}  // namespace engram::world

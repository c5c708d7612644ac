// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/parallel.h"
#include "engram/world/scene.h"

#include <cmath>

namespace engram::world {
namespace {

constexpr float kReach = 9.0f;      // [m]; farther lamps and windows add nothing visible
constexpr float kLampPower = 2.3f;  // irradiance at 1 m below
constexpr float kBounce = 0.55f;    // share of the light that walls give back
const Colour kLampColour = bgr(0.80f, 0.97f, 1.08f);
constexpr float kStreetLampPower = 4.0f;  // times that of a lamp in a room
constexpr int kSkyRays = 24;
constexpr float kSkyRadiance = 0.45f;  // mean of the sky, of the daylight

}  // namespace

bool Scene::visible(const Eigen::Array3f& from, const Eigen::Array3f& to) const {
  return trace(from, to - from, 0.98f).t >= 0.98f;
}

bool Scene::sunlit(const Eigen::Array3f& p) const {
  return trace(p, appearance_.toSun.array()).kind == Hit::Kind::kOutside;
}

// Direct light of lamps and windows on small surfaces in all six directions, at every cell and level.
void Scene::bakeCell(int x, int y, const std::vector<Eigen::Array3f>& panes) {
  const float level = height_ / kLevels;
  for (int k = 0; k < kLevels; ++k) {
    const Eigen::Array3f p((static_cast<float>(x) + 0.5f) * size_, (static_cast<float>(y) + 0.5f) * size_,
                           (static_cast<float>(k) + 0.5f) * level);
    const auto add = [&](const Eigen::Array3f& source, const Colour& power) {
      const Eigen::Array3f d = source - p;
      const float r2 = d.square().sum();
      const Eigen::Array3f n = d / std::sqrt(r2);
      for (int a = 0; a < 3; ++a)
        light_[lightIndex(2 * a + (n[a] > 0 ? 0 : 1), k, y, x)] +=
            power * (std::abs(n[a]) / std::max(r2, 0.35f));
    };
    for (std::size_t i = 0; i < building_.lamps().size(); ++i) {
      if (!appearance_.lampOn[i]) continue;
      const Eigen::Array3f lamp = building_.lamps()[i].position.array() - Eigen::Array3f(0, 0, 0.06f);
      const Eigen::Array3f d = lamp - p;
      const float r2 = d.square().sum();
      if (r2 > kReach * kReach || !visible(p, lamp)) continue;
      add(lamp, kLampColour * ((open_ ? kStreetLampPower : 1.0f) * kLampPower *
                               (0.15f + 0.85f * std::max(0.0f, d[2]) / std::sqrt(r2))));
    }
    for (const auto& pane : panes) {
      const Eigen::Array3f d = pane - p;
      if (d.square().sum() > kReach * kReach || !visible(p, pane)) continue;
      const int cell = building_.cellAt(pane[0], pane[1]);
      const bool alongX =
          isFloor(building_.plan().cells[static_cast<std::size_t>(std::max(0, cell - columns_))]) ||
          isFloor(building_.plan().cells[static_cast<std::size_t>(cell + columns_)]);
      const float cosine = std::abs(d[alongX ? 1 : 0]) / std::sqrt(d.square().sum());
      add(pane, appearance_.daylight * (size_ * (kWindowHead - kSill) * cosine * 0.5f));
    }
  }
}

// Light of the open sky: rays spread evenly over the upper half of the sphere.
void Scene::addSky(int x, int y) {
  const float level = height_ / kLevels;
  const Colour share = appearance_.daylight * (kSkyRadiance * 2.0f / kSkyRays);
  for (int k = 0; k < kLevels; ++k) {
    const Eigen::Array3f p((static_cast<float>(x) + 0.5f) * size_, (static_cast<float>(y) + 0.5f) * size_,
                           (static_cast<float>(k) + 0.5f) * level);
    for (int i = 0; i < kSkyRays; ++i) {
      const float z = (static_cast<float>(i) + 0.5f) / kSkyRays, angle = 2.39996f * static_cast<float>(i);
      const float flat = std::sqrt(1 - z * z);
      const Eigen::Array3f d(flat * std::cos(angle), flat * std::sin(angle), z);
      if (trace(p, d).kind != Hit::Kind::kOutside) continue;
      for (int a = 0; a < 3; ++a)
        light_[lightIndex(2 * a + (d[a] > 0 ? 0 : 1), k, y, x)] += share * std::abs(d[a]);
    }
  }
}

// Light given back by the surfaces: spreads from cell to cell through free space.
void Scene::scatter() {
  std::vector<Colour> now(cells_.size(), Colour::Zero()), next(now.size());
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      Colour sum = Colour::Zero();
      for (int n = 0; n < 6; ++n)
        for (int k = 0; k < kLevels; ++k) sum += light_[lightIndex(n, k, y, x)];
      now[static_cast<std::size_t>(y * columns_ + x)] = sum / (6.0f * kLevels);
    }
  for (int pass = 0; pass < 12; ++pass) {
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) {
        const std::size_t i = static_cast<std::size_t>(y * columns_ + x);
        if (cells_[i].solid || cells_[i].outside) continue;
        Colour sum = now[i];
        float n = 1;
        for (const auto& [dx, dy] : kSteps) {
          const int cx = x + dx, cy = y + dy;
          if (cx < 0 || cy < 0 || cx >= columns_ || cy >= rows_) continue;
          const std::size_t j = static_cast<std::size_t>(cy * columns_ + cx);
          if (cells_[j].solid || cells_[j].outside) continue;
          sum += now[j], n += 1;
        }
        next[i] = sum / n;
      }
    now.swap(next);
  }
  const float side[6]{1, 1, 1, 1, 0.9f, 1.25f};  // the ceiling sees the floor and all walls
  for (int n = 0; n < 6; ++n)
    for (int k = 0; k < kLevels; ++k)
      for (int y = 0; y < rows_; ++y)
        for (int x = 0; x < columns_; ++x)
          light_[lightIndex(n, k, y, x)] +=
              now[static_cast<std::size_t>(y * columns_ + x)] * (kBounce * 2.2f * side[n]) +
              bgr(0.008f, 0.007f, 0.006f);
}

// Cells of walls take the mean of their free neighbours, so that interpolation beside them stays right.
void Scene::fillSolid() {
  const std::vector<Colour> before = light_;
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      if (!cells_[static_cast<std::size_t>(y * columns_ + x)].solid) continue;
      for (int n = 0; n < 6; ++n)
        for (int k = 0; k < kLevels; ++k) {
          Colour sum = Colour::Zero();
          int count = 0;
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
              const int cx = x + dx, cy = y + dy;
              if (cx < 0 || cy < 0 || cx >= columns_ || cy >= rows_) continue;
              const Cell& c = cells_[static_cast<std::size_t>(cy * columns_ + cx)];
              if (c.solid || c.outside) continue;
              sum += before[lightIndex(n, k, cy, cx)], ++count;
            }
          if (count > 0) light_[lightIndex(n, k, y, x)] = sum / static_cast<float>(count);
        }
    }
}

// Marks the cells where direct sun may fall, so that the others need no ray to the sun.
void Scene::findSun() {
  if ((appearance_.sunlight < 0.01f).all()) return;
  std::vector<bool> lit(cells_.size(), false);
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      const std::size_t i = static_cast<std::size_t>(y * columns_ + x);
      if (cells_[i].solid || cells_[i].outside) continue;
      for (const float z : {0.05f, 0.5f, 1.0f, 1.5f, 2.0f})
        for (const float f : {0.1f, 0.5f, 0.9f})
          for (const float g : {0.1f, 0.5f, 0.9f})
            if (!lit[i] && z > cells_[i].floor && z < cells_[i].ceiling)
              lit[i] = sunlit({(static_cast<float>(x) + f) * size_, (static_cast<float>(y) + g) * size_, z});
    }
  for (int y = 1; y + 1 < rows_; ++y)
    for (int x = 1; x + 1 < columns_; ++x)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (lit[static_cast<std::size_t>((y + dy) * columns_ + x + dx)])
            cells_[static_cast<std::size_t>(y * columns_ + x)].sunny = true;
}

void Scene::bakeLight(int threads) {
  light_.assign(static_cast<std::size_t>(6) * kLevels * rows_ * columns_, Colour::Zero());
  std::vector<Eigen::Array3f> panes;  // just inside each window
  const Plan& plan = building_.plan();
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      if (plan.at(x, y) != '=') continue;
      Eigen::Array3f p((static_cast<float>(x) + 0.5f) * size_, (static_cast<float>(y) + 0.5f) * size_,
                       (kSill + kWindowHead) / 2);
      for (const auto& [dx, dy] : kSteps)
        if (isFloor(plan.at(x + dx, y + dy)))
          p += Eigen::Array3f(static_cast<float>(dx), static_cast<float>(dy), 0) * (size_ * 0.4f);
      panes.push_back(p);
    }
  base::parallelFor(static_cast<std::size_t>(rows_), threads, [&](std::size_t y) {
    for (int x = 0; x < columns_; ++x) {
      const Cell& c = cells_[y * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)];
      if (c.solid || c.outside) continue;
      bakeCell(x, static_cast<int>(y), panes);
      if (open_) addSky(x, static_cast<int>(y));
    }
  });
  scatter();
  fillSolid();
  findSun();
}

}  // namespace engram::world

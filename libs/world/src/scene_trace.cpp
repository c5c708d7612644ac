// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/scene.h"

#include <bit>
#include <cmath>
#include <numbers>

namespace engram::world {
namespace {

using Eigen::Array3f;

constexpr float kPainted = 30.0f;     // [m] distance that the scenery outside is painted for
constexpr float kClouds = 0.12f;      // share of its height, from above, that is nothing but sky
constexpr float kGrimeScale = 0.19f;  // repetitions per metre, no simple ratio to those of the walls

int mipLevel(float texels, float dither) {
  // log2 from the bits of the float: the fraction is linear, which is what the dither wants.
  if (texels <= 1.0f) return 0;
  return static_cast<int>(static_cast<float>(std::bit_cast<std::int32_t>(texels) - (127 << 23)) * 0x1p-23f +
                          dither);
}

// Whether a ray passes the axis of a pillar near enough and before t; most do not.
bool passes(const Pillar& q, const Array3f& o, const Array3f& d, float t) {
  constexpr float widest = 0.45f * 0.45f;
  const float dx = q.centre.x() - o[0], dy = q.centre.y() - o[1];
  const float flat2 = d[0] * d[0] + d[1] * d[1], cross = d[0] * dy - d[1] * dx, dot = dx * d[0] + dy * d[1];
  return cross * cross <= widest * flat2 && dot > 0.05f * flat2 && dot < t * flat2 && flat2 > 1e-8f;
}

float slant(float cosine) {
  return 1.0f / std::sqrt(std::max(std::abs(cosine), 0.05f));
}  // between isotropic and full

}  // namespace

void Scene::hitBoxes(const Cell& cell, const Array3f& o, const Array3f& inverse, float until,
                     Hit& hit) const {
  for (int i = cell.boxes.first; i < cell.boxes.first + cell.boxes.count; ++i) {
    const Box& b = boxes_[static_cast<std::size_t>(boxIndex_[static_cast<std::size_t>(i)])];
    float enter = 1e-4f, leave = until;
    int axis = -1;
    for (int a = 0; a < 3; ++a) {
      float t0 = (b.low[a] - o[a]) * inverse[a], t1 = (b.high[a] - o[a]) * inverse[a];
      if (t0 > t1) std::swap(t0, t1);
      if (t0 > enter) enter = t0, axis = a;
      leave = std::min(leave, t1);
    }
    if (axis < 0 || enter > leave || enter >= hit.t) continue;
    hit.t = enter;
    hit.kind = Hit::Kind::kBox;
    hit.side = 2 * axis + (inverse[axis] > 0 ? 0 : 1);
    hit.box = boxIndex_[static_cast<std::size_t>(i)];
  }
}

Hit Scene::trace(const Array3f& o, const Array3f& d, float limit) const {
  const auto nonZero = [](float v) { return std::abs(v) > 1e-9f ? v : std::copysign(1e-9f, v); };
  const Array3f inverse(1 / nonZero(d[0]), 1 / nonZero(d[1]), 1 / nonZero(d[2]));
  int x = static_cast<int>(std::floor(o[0] / size_)), y = static_cast<int>(std::floor(o[1] / size_));
  const int stepX = inverse[0] > 0 ? 1 : -1, stepY = inverse[1] > 0 ? 1 : -1;
  float nextX = (static_cast<float>(x + (stepX > 0)) * size_ - o[0]) * inverse[0];
  float nextY = (static_cast<float>(y + (stepY > 0)) * size_ - o[1]) * inverse[1];
  const float deltaX = size_ * std::abs(inverse[0]), deltaY = size_ * std::abs(inverse[1]);
  Hit hit;
  for (;;) {
    hit.t = limit, hit.kind = Hit::Kind::kOutside;
    if (x < 0 || y < 0 || x >= columns_ || y >= rows_) return hit;
    hit.cell = y * columns_ + x;
    const Cell& cell = cells_[static_cast<std::size_t>(hit.cell)];
    if (cell.outside) return hit;
    const float exit = std::min(nextX, nextY);
    const bool up = inverse[2] > 0;
    const float level = ((up ? cell.ceiling : cell.floor) - o[2]) * inverse[2];
    const bool leaves = open_ && up && level <= exit;  // above the houses is the sky
    if (level <= exit && level < limit && !leaves) {
      hit.t = level, hit.kind = up ? Hit::Kind::kCeiling : Hit::Kind::kFloor;
      hit.side = up ? 4 : 5;
    }
    if (cell.boxes.count > 0) hitBoxes(cell, o, inverse, std::min({exit, level, limit}) + 1e-4f, hit);
    if (hit.kind != Hit::Kind::kOutside || exit >= limit || leaves) return hit;
    const bool alongX = nextX < nextY;
    const int cx = x + (alongX ? stepX : 0), cy = y + (alongX ? 0 : stepY);
    if (cx >= 0 && cy >= 0 && cx < columns_ && cy < rows_) {
      const Cell& beyond = cells_[static_cast<std::size_t>(cy * columns_ + cx)];
      const float z = o[2] + exit * d[2];
      if (beyond.solid || z < beyond.floor || z > beyond.ceiling) {
        hit.t = exit, hit.kind = Hit::Kind::kWall;
        hit.side = alongX ? (stepX > 0 ? 0 : 1) : (stepY > 0 ? 2 : 3);
        return hit;
      }
    }
    x = cx, y = cy;
    (alongX ? nextX : nextY) += alongX ? deltaX : deltaY;
  }
}

Colour Scene::irradiance(const Array3f& p, int normal) const {
  const float step = height_ / kLevels, sign = normal % 2 ? -1.0f : 1.0f;
  const int axis = normal / 2;
  Array3f q = p;
  q[axis] += sign * 0.5f * (axis == 2 ? step : size_);  // the free cell before the surface
  const float fx = std::clamp(q[0] / size_ - 0.5f, 0.0f, static_cast<float>(columns_) - 1.001f);
  const float fy = std::clamp(q[1] / size_ - 0.5f, 0.0f, static_cast<float>(rows_) - 1.001f);
  const float fz = std::clamp(q[2] / step - 0.5f, 0.0f, kLevels - 1.001f);
  const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
  const float tx = fx - static_cast<float>(x), ty = fy - static_cast<float>(y),
              tz = fz - static_cast<float>(z);
  const Colour* a = &light_[lightIndex(normal, z, y, x)];
  const Colour* b = a + columns_;
  const Colour* c = a + static_cast<std::ptrdiff_t>(rows_) * columns_;
  const Colour* e = c + columns_;
  const Colour low = (a[0] * (1 - tx) + a[1] * tx) * (1 - ty) + (b[0] * (1 - tx) + b[1] * tx) * ty;
  const Colour high = (c[0] * (1 - tx) + c[1] * tx) * (1 - ty) + (e[0] * (1 - tx) + e[1] * tx) * ty;
  return low * (1 - tz) + high * tz;
}

float Scene::shadeAt(float x, float y) const {
  const int w = columns_ * kFine, h = rows_ * kFine;
  const float fx = std::clamp(x / size_ * kFine - 0.5f, 0.0f, static_cast<float>(w) - 1.01f);
  const float fy = std::clamp(y / size_ * kFine - 0.5f, 0.0f, static_cast<float>(h) - 1.01f);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const float tx = fx - static_cast<float>(ix), ty = fy - static_cast<float>(iy);
  const float* s = &shade_[static_cast<std::size_t>(iy) * w + ix];
  return (s[0] * (1 - tx) + s[1] * tx) * (1 - ty) + (s[w] * (1 - tx) + s[w + 1] * tx) * ty;
}

Colour Scene::wallColour(const Hit& hit, const Array3f& p, float metres, float dither) const {
  const Cell& cell = cells_[static_cast<std::size_t>(hit.cell)];
  const float a = hit.side < 2 ? p[1] : p[0];
  const Range& range = cell.decals[static_cast<std::size_t>(hit.side)];
  for (int i = range.first; i < range.first + range.count; ++i) {
    const Decal& d = decals_[static_cast<std::size_t>(i)];
    if (a < d.a0 || a > d.a1 || p[2] < d.z0 || p[2] > d.z1) continue;
    const Texture& texture = library_.atlas[d.texture];
    const float u = (a - d.a0) / (d.a1 - d.a0), v = (d.z1 - p[2]) / (d.z1 - d.z0);
    const float texels = metres * static_cast<float>(texture.width()) / (d.a1 - d.a0);
    return texture.sample(d.flip ? 1 - u : u, v, mipLevel(texels, dither));
  }
  if (p[2] < 0.09f)
    return library_.atlas[library_.woods[0]].sample(a, p[2], mipLevel(metres * 256, dither)) * 0.5f;
  const Texture& wall = library_.atlas[cell.wall];
  const Texture& grime = library_.atlas[library_.grime];
  const float shift = static_cast<float>(hit.side) * 0.31f + 0.07f * (hit.side < 2 ? p[0] : p[1]);
  const Colour dirt = grime.sample(a * kGrimeScale + shift, p[2] * kGrimeScale + shift,
                                   mipLevel(metres * 512 * kGrimeScale, dither));
  const float scale = cell.wallScale;
  return wall.sample(a * scale, -p[2] * scale,
                     mipLevel(metres * static_cast<float>(wall.width()) * scale, dither)) *
         dirt * 3.9f;
}

Colour Scene::boxColour(const Hit& hit, const Array3f& p, float metres, float dither, float& glow) const {
  const Box& b = boxes_[static_cast<std::size_t>(hit.box)];
  const int normal = hit.side ^ 1;  // the ray goes along `side`
  const bool front = b.front >= 0 && (normal == b.facing || (b.bothSides && hit.side == b.facing));
  const int axis = hit.side / 2, along = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
  if (!front) {
    const Texture& t = library_.atlas[b.body];
    return t.sample(p[along], -p[up], mipLevel(metres * static_cast<float>(t.width()), dither));
  }
  glow = b.glow;
  const Texture& t = library_.atlas[b.front];
  float u = (p[along] - b.low[along]) / (b.high[along] - b.low[along]);
  const float v = (b.high[up] - p[up]) / (b.high[up] - b.low[up]);
  if (hit.side == 0 || hit.side == 3) u = 1 - u;
  return t.sample(u, v,
                  mipLevel(metres * static_cast<float>(t.width()) / (b.high[along] - b.low[along]), dither));
}

Colour Scene::surface(const Hit& hit, const Array3f& p, float metres, float dither, float& glow) const {
  const Cell& cell = cells_[static_cast<std::size_t>(hit.cell)];
  switch (hit.kind) {
    case Hit::Kind::kBox:
      return boxColour(hit, p, metres, dither, glow);
    case Hit::Kind::kWall: {
      const float low = open_ ? p[2] : std::min(p[2], height_ - p[2]);
      return wallColour(hit, p, metres, dither) * (1 - 0.3f / (1 + 60 * low * low));
    }
    case Hit::Kind::kFloor: {
      const Texture& t = library_.atlas[cell.floorTexture];
      const Texture& grime = library_.atlas[library_.grime];
      const float s = cell.floorScale;
      return t.sample(p[0] * s, p[1] * s, mipLevel(metres * static_cast<float>(t.width()) * s, dither)) *
             grime.sample(p[0] * kGrimeScale, p[1] * kGrimeScale,
                          mipLevel(metres * 512 * kGrimeScale, dither)) *
             (3.9f * (cell.floor > 0 ? 1.0f : shadeAt(p[0], p[1])));
    }
    default: {
      if (cell.ceiling < height_)
        return library_.atlas[library_.white].sample(p[0], p[1], mipLevel(metres * 512, dither));
      constexpr float s = 1 / 2.4f;
      return library_.atlas[library_.ceiling].sample(p[0] * s, p[1] * s, mipLevel(metres * 512 * s, dither));
    }
  }
}

Colour Scene::skyColour(const Array3f& o, const Array3f& d, float footprint, float dither) const {
  const float cx = static_cast<float>(columns_) * size_ / 2, cy = static_cast<float>(rows_) * size_ / 2;
  const float ox = o[0] - cx, oy = o[1] - cy;
  const float a = std::max(d[0] * d[0] + d[1] * d[1], 1e-9f), b = ox * d[0] + oy * d[1];
  const float t = (-b + std::sqrt(std::max(0.0f, b * b - a * (ox * ox + oy * oy - far_ * far_)))) / a;
  const float angle = std::atan2(oy + t * d[1], ox + t * d[0]);
  const float u = 0.5f - angle / (2 * std::numbers::pi_v<float>);
  // The picture was painted for 30 m: farther away all of it is larger. Under the open sky the clouds go on
  // above it, mirrored.
  float v = (24.0f - (o[2] + t * d[2]) * (kPainted / far_)) / 32.0f;
  if (open_ && v < 0) v = std::abs(std::remainder(v, 2 * kClouds));
  v = std::clamp(v, 0.004f, 0.996f);
  const Texture& view = library_.atlas[library_.outside[static_cast<std::size_t>(appearance_.season)]];
  const float texels =
      footprint * far_ * static_cast<float>(view.width()) / (2 * std::numbers::pi_v<float> * far_);
  return view.sample(u, v, mipLevel(texels, dither)) * appearance_.daylight * 0.55f;
}

bool Scene::pillarColour(const Pillar& q, const Array3f& o, const Array3f& d, float footprint, float dither,
                         float& t, Colour& out) const {
  const float dx = q.centre.x() - o[0], dy = q.centre.y() - o[1];
  const float flat = std::sqrt(d[0] * d[0] + d[1] * d[1]);
  const float at = (dx * d[0] + dy * d[1]) / (flat * flat);
  const float b = (d[0] * dy - d[1] * dx) / flat;  // the axis is this far to the left of the ray
  const float f = (o[2] + at * d[2]) / q.height;
  if (f < 0 || f > 1) return false;
  float radius = 0, offset = b;
  const float relative = std::atan2(-d[1], -d[0]) - q.heading;  // where the viewer is, from the front
  if (q.plant) {
    const float leaf = std::sin(37 * f + 5 * relative) * std::sin(23 * b / q.height * 4 + 61 * f);
    radius = f < 0.22f
                 ? 0.15f
                 : 0.30f * std::sqrt(std::max(0.0f, 1 - std::pow((f - 0.6f) / 0.42f, 2.0f))) + 0.05f * leaf;
  } else if (f < 0.48f) {
    const float apart = 0.09f * std::abs(std::cos(relative)) +
                        0.16f * q.stride * std::abs(std::sin(relative)) * (1 - f / 0.48f);
    offset = std::abs(b) - std::abs(apart);
    radius = 0.06f + 0.05f * f;
  } else if (f < 0.82f) {
    radius = 0.17f + 0.07f * (f - 0.48f) / 0.34f;
    if (f > 0.78f) radius *= 1 - 6 * (f - 0.78f);
  } else {
    const float head = (f - 0.925f) / 0.075f;
    radius = f < 0.86f ? 0.06f : 0;
    if (std::abs(head) < 1) radius = std::max(radius, 0.10f * std::sqrt(1 - head * head));
  }
  if (std::abs(offset) >= radius) return false;
  const float across =
      -b / (f < 0.48f && !q.plant ? 0.24f : std::max(radius, 0.01f));  // to the right, -1 … 1
  const float u =
      0.5f + (std::asin(std::clamp(across, -1.0f, 1.0f)) - relative) / (2 * std::numbers::pi_v<float>);
  const Texture& texture = library_.atlas[q.texture];
  const float metres = footprint * at;
  out = texture.sample(u, 1 - f, mipLevel(metres * static_cast<float>(texture.height()) / q.height, dither));
  if (q.plant && f < 0.22f) out = bgr(0.10f, 0.16f, 0.35f);
  const float depth = std::sqrt(std::max(0.0f, 1 - across * across));
  const float nx = (-d[0] * depth + d[1] * across) / flat, ny = (-d[1] * depth - d[0] * across) / flat;
  const Array3f p(q.centre.x(), q.centre.y(), o[2] + at * d[2]);
  out *= irradiance(p, nx > 0 ? 0 : 1) * (nx * nx) + irradiance(p, ny > 0 ? 2 : 3) * (ny * ny);
  t = at;
  return true;
}

Colour Scene::radiance(const Array3f& o, const Array3f& d, float footprint, float dither,
                       std::span<const Pillar> people) const {
  const Hit hit = trace(o, d);
  float t = hit.t;
  Colour out = Colour::Zero();
  bool covered = false;
  for (const auto& list : {people, std::span<const Pillar>(plants_)})
    for (const auto& q : list)
      if (passes(q, o, d, t)) covered |= pillarColour(q, o, d, footprint, dither, t, out);
  if (covered) return out;
  if (hit.kind == Hit::Kind::kOutside) return skyColour(o, d, footprint, dither);
  const Array3f p = o + d * t;
  const int normal = hit.side ^ 1;
  float glow = 0;
  const Colour colour = surface(hit, p, footprint * t * slant(d[hit.side / 2]), dither, glow);
  if (glow > 0) return colour * glow;
  Colour light = irradiance(p, normal);
  if (cells_[static_cast<std::size_t>(hit.cell)].sunny) {
    const float cosine = appearance_.toSun[hit.side / 2] * (normal % 2 ? -1.0f : 1.0f);
    if (cosine > 0) {
      Array3f start = p;
      start[hit.side / 2] += normal % 2 ? -0.004f : 0.004f;
      if (sunlit(start)) light += appearance_.sunlight * cosine;
    }
  }
  return colour * light;
}

}  // namespace engram::world

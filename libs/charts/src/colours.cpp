// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/charts/colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace engram::charts {

std::string hex(Colour c) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", c.r, c.g, c.b);
  return text;
}

Colour viridis(double fraction) {
  static constexpr std::array<std::array<double, 3>, 5> kStops{
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  const double at = std::clamp(fraction, 0.0, 1.0) * (kStops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  const double t = at - static_cast<double>(i);
  const auto mix = [&](std::size_t c) {
    return static_cast<std::uint8_t>(std::lround((1 - t) * kStops[i][c] + t * kStops[i + 1][c]));
  };
  return {mix(0), mix(1), mix(2)};
}

Colour categoryColour(std::size_t index) {
  // Found by search: the closest two of the first six differ by 37 (CIE76) for normal, protan, deutan and
  // tritan eyes; of all eight by 30.
  static constexpr std::array<Colour, 8> kColours{{{19, 25, 169},
                                                   {240, 156, 0},
                                                   {45, 201, 137},
                                                   {166, 3, 121},
                                                   {74, 21, 18},
                                                   {157, 142, 250},
                                                   {122, 97, 11},
                                                   {214, 161, 215}}};
  return kColours[index % kColours.size()];
}

}  // namespace engram::charts

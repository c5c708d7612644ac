// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/map_content.h"

#include <array>
#include <cstdint>
#include <string>

namespace engram::exporters {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};

/// #rrggbb
std::string hex(Colour c);

/// From dark violet (0) over green to yellow (1), even in lightness and safe for colour-blind eyes (viridis).
Colour viridis(double fraction);

Colour edgeColour(map::EdgeType type);

/// One of eight colours that colour-blind eyes tell apart, for sessions and the series of charts.
Colour categoryColour(std::size_t index);

/// All kinds of edges, in the order of legends.
inline constexpr std::array kEdgeTypes{map::EdgeType::kOdometry,    map::EdgeType::kLoop,
                                       map::EdgeType::kRecognition, map::EdgeType::kWeak,
                                       map::EdgeType::kCompounded,  map::EdgeType::kDeadReckoning};

/// Largest number of long-term features of any place, at least 1.
int largestLongTerm(const map::MapContent& content);

}  // namespace engram::exporters

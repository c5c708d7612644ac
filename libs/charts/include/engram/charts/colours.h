// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace engram::charts {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};

/// #rrggbb
std::string hex(Colour c);

/// From dark violet (0) over green to yellow (1), even in lightness and safe for colour-blind eyes (viridis).
Colour viridis(double fraction);

/// One of eight colours that colour-blind eyes tell apart, for sessions and the series of charts.
Colour categoryColour(std::size_t index);

}  // namespace engram::charts

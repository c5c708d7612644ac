// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace engram::sources {

/// The byte that ends each object of MRPT.
inline constexpr std::uint8_t kEndFlag = 0x88;

/// MRPT counts steps of 100 ns since the year 1601.
inline constexpr std::int64_t kTicksAtUnixEpoch = 116444736000000000;

/// Stamps that those steps can count [s since the Unix epoch]: the years 1601 to 30827.
inline constexpr double kFirstRawlogStamp = -1.16444e10, kLastRawlogStamp = 9.1e11;
inline bool fitsRawlog(double stamp) { return stamp > kFirstRawlogStamp && stamp < kLastRawlogStamp; }

/// @param stamp [s since the Unix epoch], 0, which means none, where it does not fitsRawlog()
inline std::uint64_t rawlogTicks(double stamp) {
  if (!fitsRawlog(stamp)) return 0;
  return static_cast<std::uint64_t>(std::llround(stamp * 1e7) + kTicksAtUnixEpoch);
}

/// [s since the Unix epoch]; NaN when the recorder set none.
inline double unixSeconds(std::uint64_t ticks) {
  if (ticks == 0) return std::numeric_limits<double>::quiet_NaN();
  constexpr auto kEpoch = static_cast<std::uint64_t>(kTicksAtUnixEpoch);
  return ticks >= kEpoch ? static_cast<double>(ticks - kEpoch) * 1e-7
                         : -static_cast<double>(kEpoch - ticks) * 1e-7;
}

}  // namespace engram::sources

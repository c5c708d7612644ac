// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace engram::sources {

/// The unit that stamps are written in. kAuto: to be told from the stamps.
enum class StampUnit { kAuto, kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };

/// "s", "ms", "us" or "ns"; empty for kAuto.
std::string toString(StampUnit unit);
/// The names of toString().
std::vector<std::string> stampUnitNames();
/// kAuto for a name that is none.
StampUnit stampUnitOf(const std::string& name);

/// What stamps were taken for.
struct StampReading {
  StampUnit unit = StampUnit::kAuto;
  std::string why;  ///< a sentence for the user
};

/// Tells the unit by the time since 1970, or else by the time between images. Other units that are possible
/// too are named in `why`.
/// @param written stamps as they stand in the file, in its order; finite
StampReading tellStampUnit(std::span<const double> written);

/// A stamp [s] as the nearest double: no digit of a time in nanoseconds is lost on the way.
/// None when `written` is not wholly a finite number. @param unit not kAuto
std::optional<double> secondsOf(const std::string& written, StampUnit unit);

}  // namespace engram::sources

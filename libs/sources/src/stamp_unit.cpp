// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/stamp_unit.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace engram::sources {
namespace {

struct Unit {
  StampUnit unit;
  const char* name;
  const char* word;
  int digits;  ///< decimal, from seconds to this unit
  double seconds;
};

constexpr std::array<Unit, 4> kUnits{{{StampUnit::kSeconds, "s", "seconds", 0, 1.0},
                                      {StampUnit::kMilliseconds, "ms", "milliseconds", 3, 1e-3},
                                      {StampUnit::kMicroseconds, "us", "microseconds", 6, 1e-6},
                                      {StampUnit::kNanoseconds, "ns", "nanoseconds", 9, 1e-9}}};

struct Interval {
  double low, high;  // [s]
  bool contains(double value) const { return value >= low && value <= high; }
};
constexpr Interval kOurTime{6.3e8, 4.2e9};  // since 1970: the years 1990 to 2103
constexpr Interval kTimedGap{
    1e-4, 4 * 3600.0};  // between images with such stamps; beyond: since power-on, in a finer unit
constexpr Interval kLikelyGap{0.004, 5.0};  // between images of a drive
constexpr Interval kPossibleGap{0.002, 120.0};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of the steps forward; 0 when there is none.
double typicalStep(std::span<const double> stamps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (stamps[i] > stamps[i - 1]) steps.push_back(stamps[i] - stamps[i - 1]);
  return median(std::move(steps));
}

std::string inSeconds(double step, const Unit& unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.3g s", step * unit.seconds);
  return text;
}

std::vector<const Unit*> unitsWithin(const Interval& interval, double value) {
  std::vector<const Unit*> units;
  for (const auto& unit : kUnits)
    if (interval.contains(value * unit.seconds)) units.push_back(&unit);
  return units;
}

/// @param others that would be possible too
StampReading reading(const Unit& unit, const std::string& because, double step,
                     const std::vector<const Unit*>& others) {
  std::string why = std::string("the stamps were taken for ") + unit.word + ": " + because;
  for (const Unit* other : others)
    if (other != &unit) why += "; in " + std::string(other->name) + " it would be " + inSeconds(step, *other);
  return {unit.unit, why};
}

}  // namespace

std::string toString(StampUnit unit) {
  const auto at = std::find_if(kUnits.begin(), kUnits.end(), [=](const Unit& u) { return u.unit == unit; });
  return at == kUnits.end() ? "" : at->name;
}

std::vector<std::string> stampUnitNames() {
  std::vector<std::string> names;
  for (const auto& unit : kUnits) names.emplace_back(unit.name);
  return names;
}

StampUnit stampUnitOf(const std::string& name) {
  const auto at = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == name; });
  return at == kUnits.end() ? StampUnit::kAuto : at->unit;
}

StampReading tellStampUnit(std::span<const double> written) {
  const double step = typicalStep(written);
  const auto since1970 = unitsWithin(kOurTime, median({written.begin(), written.end()}));
  const Unit* epoch = since1970.empty() ? nullptr : since1970.front();
  if (epoch != nullptr && (step == 0.0 || kTimedGap.contains(step * epoch->seconds)))
    return reading(*epoch, "they are times since 1970", step, {});
  if (step == 0.0) return reading(kUnits[0], "one alone does not tell", step, {});
  const auto likely = unitsWithin(kLikelyGap, step);
  auto possible = unitsWithin(kPossibleGap, step);
  if (epoch != nullptr && std::find(possible.begin(), possible.end(), epoch) == possible.end())
    possible.push_back(epoch);
  const Unit& taken = !likely.empty()     ? *likely.front()
                      : epoch != nullptr  ? *epoch
                      : !possible.empty() ? *possible.front()
                                          : kUnits[0];
  return reading(taken, inSeconds(step, taken) + " lie between images", step, possible);
}

std::optional<double> secondsOf(const std::string& written, StampUnit unit) {
  const auto at = std::find_if(kUnits.begin(), kUnits.end(), [=](const Unit& u) { return u.unit == unit; });
  const auto mark = written.find_first_of("eE");
  int exponent = 0;
  if (mark != std::string::npos) {
    const char* first = written.data() + mark + 1 + (written.compare(mark + 1, 1, "+") == 0 ? 1 : 0);
    const char* last = written.data() + written.size();
    const auto [end, status] = std::from_chars(first, last, exponent);
    if (status != std::errc() || end != last || std::abs(exponent) > 1000) return std::nullopt;
  }
  // The decimal point is moved in the text: a double holds no 19 digits.
  const std::string shifted = written.substr(0, mark) + "e" + std::to_string(exponent - at->digits);
  double seconds = 0.0;
  const auto [end, status] = std::from_chars(shifted.data(), shifted.data() + shifted.size(), seconds);
  if (status != std::errc() || end != shifted.data() + shifted.size() || !std::isfinite(seconds))
    return std::nullopt;
  return seconds;
}

}  // namespace engram::sources

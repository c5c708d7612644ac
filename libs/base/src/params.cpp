// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/params.h"

#include "engram/base/error.h"
#include "engram/base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace engram::base {
namespace {

std::string toText(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

template <class T>
T parseNumber(const std::string& text, const char* kind) {
  T value{};
  const char* first = text.data();
  const char* last = first + text.size();
  if (last - first > 1 && *first == '+' && first[1] != '-') ++first;
  const auto [end, status] = std::from_chars(first, last, value);
  if (status != std::errc() || end != last || !std::isfinite(static_cast<double>(value)))
    throw ConfigError(base::quoted(text) + " is not " + kind);
  return value;
}

void checkRange(double value, Range range) {
  if (value >= range.low && value <= range.high) return;  // NaN fails too
  std::string bound;
  if (std::isinf(range.high))
    bound = ">= " + toText(range.low);
  else if (std::isinf(range.low))
    bound = "<= " + toText(range.high);
  else
    bound = "in [" + toText(range.low) + ", " + toText(range.high) + "]";
  throw ConfigError(toText(value) + " is out of range: must be " + bound);
}

double degrees(double radians) { return radians * (180.0 / std::numbers::pi); }

/// What a person wrote: 10 degrees stored in radians prints as 10 and not as 9.999999999999998.
std::string printDegrees(double radians) {
  const double exact = degrees(radians);
  const double rounded = std::round(exact * 1e9) / 1e9;
  return toText(rounded);
}

}  // namespace

void Params::add(const std::string& key, double& value, const std::string& help, Range range) {
  double* v = &value;
  const auto check = [v, range] { checkRange(*v, range); };
  fields_.push_back({key, help, [v](const std::string& s) { *v = parseNumber<double>(s, "a number"); },
                     [v] { return toText(*v); }, check});
}

void Params::add(const std::string& key, int& value, const std::string& help, Range range) {
  int* v = &value;
  const auto check = [v, range] { checkRange(*v, range); };
  fields_.push_back({key, help, [v](const std::string& s) { *v = parseNumber<int>(s, "a whole number"); },
                     [v] { return std::to_string(*v); }, check});
}

void Params::add(const std::string& key, bool& value, const std::string& help) {
  bool* v = &value;
  const auto parse = [v](const std::string& s) {
    if (s == "true" || s == "yes" || s == "1") return void(*v = true);
    if (s == "false" || s == "no" || s == "0") return void(*v = false);
    throw ConfigError(base::quoted(s) + " is neither true nor false");
  };
  fields_.push_back({key, help, parse, [v] { return std::string(*v ? "true" : "false"); }, [] {}});
}

void Params::add(const std::string& key, std::string& value, const std::string& help) {
  std::string* v = &value;
  fields_.push_back({key, help, [v](const std::string& s) { *v = s; }, [v] { return *v; }, [] {}});
}

void Params::addDegrees(const std::string& key, double& radians, const std::string& help, Range range) {
  double* v = &radians;
  const auto parse = [v](const std::string& s) {
    *v = parseNumber<double>(s, "a number") * (std::numbers::pi / 180.0);
  };
  const auto check = [v, range] { checkRange(std::round(degrees(*v) * 1e9) / 1e9, range); };
  fields_.push_back({key, help, parse, [v] { return printDegrees(*v); }, check});
}

void Params::addChoice(const std::string& key, std::string& value, const std::string& help,
                       const std::vector<std::string>& names) {
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : " | ") + name;
  std::string* v = &value;
  const auto check = [v, names, list] {
    if (std::find(names.begin(), names.end(), *v) == names.end())
      throw ConfigError(base::quoted(*v) + " is not one of " + list);
  };
  fields_.push_back(
      {key, help + " (" + list + ")", [v](const std::string& s) { *v = s; }, [v] { return *v; }, check});
}

}  // namespace engram::base

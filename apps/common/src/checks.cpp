// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/checks.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace engram::apps {
namespace {

constexpr std::size_t kShown = 40;  // characters of a wrong value in a message

std::string shown(const std::string& text) {
  return "'" + text.substr(0, kShown) + (text.size() > kShown ? "…" : "") + "'";
}

std::string shortText(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

template <class T>
std::optional<T> wholly(const std::string& text) {
  T value{};
  const char* first = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  const char* last = text.data() + text.size();
  const auto [end, status] = std::from_chars(first, last, value);
  if (status != std::errc() || end != last) return std::nullopt;
  return value;
}

/// Why a text is no number, or not the kind of number that is wanted.
std::string notANumber(const std::string& text, const char* kind) {
  std::string point = text;
  std::replace(point.begin(), point.end(), ',', '.');
  if (std::count(text.begin(), text.end(), ',') == 1 && wholly<double>(point))
    return shown(text) + " is not " + kind + ": the decimal sign is a point, " + point;
  return shown(text) + " is not " + kind;
}

CLI::Validator real(const std::function<bool(double)>& holds, const std::string& bound) {
  const auto check = [holds, bound](std::string& text) -> std::string {
    const auto value = wholly<double>(text);
    if (!value || !std::isfinite(*value)) return notANumber(text, "a number");
    return holds(*value) ? std::string() : shown(text) + " is out of range: must be " + bound;
  };
  return CLI::Validator(check, bound);
}

CLI::Validator whole(int low, std::optional<int> high, const std::string& bound) {
  const auto check = [=](std::string& text) -> std::string {
    const auto value = wholly<long long>(text);
    if (!value && !wholly<double>(text)) return notANumber(text, "a whole number");
    if (!value) return shown(text) + " is not a whole number";
    const bool inside = *value >= low && *value <= high.value_or(std::numeric_limits<int>::max());
    return inside ? std::string() : shown(text) + " is out of range: must be " + bound;
  };
  return CLI::Validator(check, bound);
}

std::string interval(double low, double high) {
  return "in [" + shortText(low) + ", " + shortText(high) + "]";
}

}  // namespace

CLI::Validator positive() {
  return real([](double v) { return v > 0; }, "> 0");
}

CLI::Validator notNegative() {
  return real([](double v) { return v >= 0; }, ">= 0");
}

CLI::Validator between(double low, double high) {
  return real([=](double v) { return v >= low && v <= high; }, interval(low, high));
}

CLI::Validator wholeFrom(int low) { return whole(low, std::nullopt, ">= " + std::to_string(low)); }

CLI::Validator wholeBetween(int low, int high) { return whole(low, high, interval(low, high)); }

}  // namespace engram::apps

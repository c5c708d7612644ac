// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "text_lines.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"

#include <charconv>
#include <cmath>
#include <sstream>

namespace engram::evaluation {
namespace {

std::string trimmed(const std::string& s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

template <class T>
bool parseWhole(const std::string& field, T& value) {
  const char* end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

}  // namespace

void refuse(const std::string& origin, const std::string& what) { throw base::Error(origin + ": " + what); }

std::vector<TextLine> contentLines(const std::string& text, const std::string& name) {
  std::vector<TextLine> lines;
  std::istringstream in(base::plainText(text, name));
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    lines.push_back({content, name + ":" + std::to_string(number)});
  }
  return lines;
}

std::vector<std::string> splitFields(const std::string& text, char separator) {
  std::vector<std::string> fields;
  std::istringstream in(text);
  std::string field;
  if (separator == ' ') {
    while (in >> field) fields.push_back(field);
    return fields;
  }
  while (std::getline(in, field, separator)) fields.push_back(trimmed(field));
  if (!text.empty() && text.back() == separator) fields.emplace_back();
  return fields;
}

std::int64_t parseInteger(const std::string& field, const std::string& origin, const std::string& what) {
  std::int64_t value = 0;
  if (!parseWhole(field, value)) refuse(origin, what + " " + base::quoted(field) + " is not a whole number");
  return value;
}

double parseReal(const std::string& field, const std::string& origin, const std::string& what) {
  double value = 0;
  if (!parseWhole(field, value) || !std::isfinite(value))
    refuse(origin, what + " " + base::quoted(field) + " is not a number");
  return value;
}

}  // namespace engram::evaluation

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/charts/markup.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace engram::charts {
namespace {

/// Length of the UTF-8 sequence at `i`, 0 when it is not valid.
std::size_t utf8Length(const std::string& text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(i);
  const std::size_t n = first < 0x80                    ? 1
                        : first >= 0xC2 && first < 0xE0 ? 2
                        : first >= 0xE0 && first < 0xF0 ? 3
                        : first >= 0xF0 && first < 0xF5 ? 4
                                                        : 0;
  for (std::size_t k = 1; k < n; ++k)
    if ((byte(i + k) & 0xC0) != 0x80) return 0;
  if ((first == 0xE0 && byte(i + 1) < 0xA0) || (first == 0xED && byte(i + 1) >= 0xA0) ||
      (first == 0xF0 && byte(i + 1) < 0x90) || (first == 0xF4 && byte(i + 1) >= 0x90))
    return 0;
  return n;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = utf8Length(text, i);
    const char c = text[i];
    if (n == 0 || (n == 1 && static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t'))
      out += "\xEF\xBF\xBD";
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out.append(text, i, n);
    i += std::max<std::size_t>(n, 1);
  }
  return out;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  char text[64];
  if (value == std::round(value) && std::abs(value) < 1e9)
    std::snprintf(text, sizeof text, "%.0f", value == 0 ? 0.0 : value);
  else
    std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

double textWidth(const std::string& text, double fontSize) {
  // Measured on DejaVu Sans, the widest of the usual fonts; in units of the font size.
  static constexpr std::string_view kNarrow = "iIjl.,:;'|! ", kMedium = "ftr()[]-/\"", kWide = "mwMW@%";
  double sum = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0) == 0x80) continue;  // the rest of a letter
    if (kNarrow.find(c) != std::string_view::npos)
      sum += 0.32;
    else if (kMedium.find(c) != std::string_view::npos)
      sum += 0.41;
    else if (kWide.find(c) != std::string_view::npos)
      sum += 0.97;
    else
      sum += c >= 'A' && c <= 'Z' ? 0.72 : 0.63;
  }
  return sum * fontSize;
}

std::vector<std::string> wrapped(const std::string& text, double width, double fontSize) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    std::string& line = lines.back();
    const std::string longer = line.empty() ? word : line + " " + word;
    if (line.empty() || textWidth(longer, fontSize) <= width)
      line = longer;
    else
      lines.push_back(word);
    at = end + 1;
  }
  return lines;
}

}  // namespace engram::charts

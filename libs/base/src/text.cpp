// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/text.h"

#include <cstdint>
#include <cstdio>

namespace engram::base {
namespace {

constexpr std::size_t kShown = 80;  // characters

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 1;
  bool valid = false;
};

/// The first character of a text that is not empty: no overlong forms, no surrogates (RFC 3629).
Character firstOf(std::string_view text) {
  const auto at = [text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = at(0);
  if (lead < 0x80) return {lead, 1, true};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((at(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (at(i) & 0x3Fu);
  }
  const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  if (overlong || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
  return {code, bytes, true};
}

/// Controls, line ends of Unicode, and what makes text read in another order than it is written.
bool isHidden(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x061C ||
         (code >= 0x200B && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF;
}

std::string escaped(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) {
    char text[8];
    std::snprintf(text, sizeof text, "\\x%02x", static_cast<unsigned>(static_cast<std::uint8_t>(c)));
    out += c == '\n' ? "\\n" : c == '\t' ? "\\t" : c == '\r' ? "\\r" : text;
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out, last;  // the last character shown gives way to the mark of shortening
  for (std::size_t shown = 0; !text.empty(); ++shown) {
    if (shown == kShown) return out + "…";
    out += last;
    const Character c = firstOf(text);
    const std::string_view bytes = text.substr(0, c.bytes);
    last = c.valid && !isHidden(c.code) ? std::string(bytes) : escaped(bytes);
    text.remove_prefix(c.bytes);
  }
  return out + last;
}

std::string forTerminal(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character c = firstOf(text);
    const std::string_view bytes = text.substr(0, c.bytes);
    const bool plain = c.valid && (!isHidden(c.code) || c.code == '\n' || c.code == '\t');
    out += plain ? std::string(bytes) : escaped(bytes);
    text.remove_prefix(c.bytes);
  }
  return out;
}

std::string quoted(std::string_view text) {
  std::string out(1, '\'');
  out += printable(text);
  return out += '\'';
}

}  // namespace engram::base

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace engram::base {

/// "1 image", "2 images".
inline std::string counted(std::size_t n, const std::string& noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

/// Text of a file as a message may show it: control characters, marks that turn the direction of writing and
/// bytes that are not UTF-8 are escaped as in C (\n, \x1b), and of more than 80 characters the first 79
/// stand, then "…". A terminal shows it as it is, and it is always valid UTF-8.
std::string printable(std::string_view text);

/// The same of a whole message: not shortened, and its line breaks and tabs stay.
std::string forTerminal(std::string_view text);

/// printable() between quotation marks. Call it as base::quoted(): std::quoted is found for std::string too.
std::string quoted(std::string_view text);

}  // namespace engram::base

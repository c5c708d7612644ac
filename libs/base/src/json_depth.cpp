// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/json_depth.h"

#include "engram/base/error.h"

#include <string>

namespace engram::base {

void requireShallowJson(std::string_view json) {
  constexpr int kDeepest = 64;  // the deepest that Engram writes is 5
  int depth = 0;
  bool inText = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '"') inText = !inText;
    if (inText) {
      if (c == '\\') ++i;  // the next character is part of the text, even a quotation mark
      continue;
    }
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) throw Error("its JSON is nested more than " + std::to_string(kDeepest) + " deep");
  }
}

}  // namespace engram::base

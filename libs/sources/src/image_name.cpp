// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_name.h"

#include <algorithm>

namespace engram::sources {
namespace {

const std::string kMark = "image file: ";

/// Rawlogs come from anywhere: a name must not carry anything that a terminal obeys.
bool isName(const std::string& name) {
  return !name.empty() && kMark.size() + name.size() <= kMaxNameComment &&
         std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; });
}

}  // namespace

std::string commentOf(const std::string& name) { return isName(name) ? kMark + name : std::string(); }

std::string nameInComment(const std::string& text) {
  if (!text.starts_with(kMark)) return {};
  const std::string name = text.substr(kMark.size());
  return isName(name) ? name : std::string();
}

}  // namespace engram::sources

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/json_file.h"

#include "engram/base/error.h"
#include "engram/base/json_depth.h"

#include <fstream>
#include <iterator>

namespace engram::apps {
namespace {

nlohmann::json parse(const std::string& path, bool throws) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    base::requireShallowJson(text);
  } catch (const base::Error& e) {
    throw base::Error(path + ": " + e.what() + "; remove it and start again");
  }
  return nlohmann::json::parse(text, nullptr, throws);
}

}  // namespace

nlohmann::json readJson(const std::string& path) { return parse(path, true); }
nlohmann::json readJsonIfAny(const std::string& path) { return parse(path, false); }

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/json_file.h"
#include "engram/base/error.h"

#include <filesystem>
#include <string>

namespace engram::apps {

/// What `read(file)` gives, made by `write(file, make())` when no earlier run has left that file. It is read
/// also when it was just made: both ways give the same digits.
template <class Make, class Write, class Read>
auto kept(const std::string& file, Make make, Write write, Read read) {
  if (!std::filesystem::exists(file)) write(file, make());
  return read(file);
}

/// Replaces a file that an interrupted experiment goes on from.
void writeKept(const std::string& path, const nlohmann::json& content);

/// What `from` makes of the content. Throws base::Error with the path of a file that is not whole.
template <class From>
auto readKept(const std::string& path, From from) {
  try {
    return from(readJson(path));
  } catch (const nlohmann::json::exception& e) {
    throw base::Error(path + " is not whole (" + e.what() + "); remove it and it is measured again");
  }
}

}  // namespace engram::apps

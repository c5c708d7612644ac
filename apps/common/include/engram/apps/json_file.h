// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace engram::apps {

/// What a JSON file of an earlier run holds. Throws json::exception when there is none or it is no JSON, and
/// base::Error when it is nested too deep.
nlohmann::json readJson(const std::string& path);

/// The same; a discarded value instead of json::exception.
nlohmann::json readJsonIfAny(const std::string& path);

/// JSON text. Bytes that are not UTF-8, such as those of file names, become U+FFFD.
/// @param indent of each level; -1 for all in one line.
template <class Json>
std::string toText(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/map_parameters.h"

#include "engram/base/config.h"
#include "engram/base/error.h"

#include <set>

namespace engram::apps {
namespace {

bool isOfTheMap(const std::string& section, const std::string& key) {
  static const std::set<std::string> whole{"memory", "fsh", "multi_store", "words"};
  return whole.contains(section) || (section == "appearance" && key == "channel");
}

}  // namespace

std::vector<std::string> parameterChanges(const std::string& stored, const std::string& wanted) {
  const auto was = base::IniFile::parse(stored, "map").sections();
  const auto now = base::IniFile::parse(wanted, "configuration").sections();
  std::vector<std::string> changes;
  for (const auto& [section, keys] : now) {
    const auto before = was.find(section);
    if (before == was.end()) continue;
    for (const auto& [key, value] : keys) {
      const auto old = before->second.find(key);
      if (old == before->second.end() || old->second.text == value.text || !isOfTheMap(section, key))
        continue;
      changes.push_back("[" + section + "] " + key + " = " + value.text + " (was " + old->second.text + ")");
    }
  }
  return changes;
}

std::string acceptedChanges(const std::vector<std::string>& changes, bool accept, const std::string& map) {
  std::string list;
  for (const std::string& change : changes) list += (list.empty() ? "" : ", ") + change;
  if (list.empty() || accept) return list;
  throw base::ConfigError("map '" + map + "' was made with other parameters: " + list +
                          ". Leave the configuration out to go on with that of the map, or give "
                          "--accept-parameters to go on with these; the map then notes it");
}

}  // namespace engram::apps

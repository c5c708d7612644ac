// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "server.h"

#include <algorithm>
#include <cctype>

namespace engram::store {
namespace {

constexpr const char* kSchemes[] = {"postgresql://", "postgres://"};
constexpr std::size_t kLongestName = 48;  // PostgreSQL cuts names after 63 bytes

[[noreturn]] void refuseAddress(const std::string& map, const std::string& why) {
  throw base::Error("'" + map + "': " + why);
}

std::string schemaNamed(const std::string& map, const std::string& name) {
  const auto isPlain = [](unsigned char c) { return std::islower(c) || std::isdigit(c) || c == '_'; };
  if (name.empty() || name.size() > kLongestName || !std::all_of(name.begin(), name.end(), isPlain))
    refuseAddress(map, "a map on a server has a name of lower-case letters, digits and _: ?map=building_2");
  return "engram_" + name;
}

/// Whoever lists processes reads command lines.
void refusePassword(const std::string& authority) {
  const auto at = authority.rfind('@');
  if (at != std::string::npos && authority.substr(0, at).find(':') != std::string::npos)
    throw base::Error(
        "the address of the map holds a password: put it into ~/.pgpass or a service file (PGSERVICEFILE)");
}

}  // namespace

bool isOnServer(const std::string& map) {
  return std::any_of(std::begin(kSchemes), std::end(kSchemes),
                     [&](const char* scheme) { return map.starts_with(scheme); });
}

ServerAddress parseAddress(const std::string& map) {
  const auto query = map.find('?');
  const auto host = map.find("//") + 2;
  refusePassword(map.substr(host, map.find('/', host) - host));
  ServerAddress address{map.substr(0, query), ""};
  char separator = '?';
  for (std::size_t at = query; at != std::string::npos && at < map.size();) {
    const std::size_t end = std::min(map.find('&', at + 1), map.size());
    const std::string pair = map.substr(at + 1, end - at - 1);
    if (pair.starts_with("password=")) refusePassword("user:password@");
    if (pair.starts_with("map=")) {
      address.schema = schemaNamed(map, pair.substr(4));
    } else if (!pair.empty()) {
      address.uri += separator + pair;
      separator = '&';
    }
    at = end;
  }
  if (address.schema.empty()) refuseAddress(map, "which map? Add ?map=NAME to the address");
  return address;
}

}  // namespace engram::store

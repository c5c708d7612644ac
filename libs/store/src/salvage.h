// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "codec.h"
#include "database.h"
#include "engram/map/map_content.h"
#include "engram/store/drive.h"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace engram::store {

/// What can be read of a damaged map: every row with a right checksum, and which are known to be lost.
struct Salvage {
  std::optional<MapState> state;
  map::MapHeader header;
  map::MapContent content;  ///< without path
  std::map<std::uint64_t, map::PathPoint> path;
  std::map<std::uint64_t, std::string> records;  ///< as JSON
  std::map<std::uint64_t, Drive> drives;
  std::set<std::uint64_t> memories;  ///< numbers of the places whose memory was read
  std::set<std::string> lostHeaders;
  std::map<std::string, std::set<std::uint64_t>> bad;  ///< numbers of unreadable rows by kind, where known

  std::size_t rows() const;
};

/// Reads around damaged pages. Never throws for damage.
Salvage salvage(Database& database);

}  // namespace engram::store

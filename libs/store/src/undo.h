// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "codec.h"
#include "connection.h"

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace engram::store {

/// The tables of rows that a drive changes.
struct RowTable {
  RowKind kind;
  const char* name;
};
inline constexpr RowTable kPlaceRows{RowKind::kPlace, "places"}, kMemoryRows{RowKind::kMemory, "memories"},
    kViewRows{RowKind::kView, "views"}, kEdgeRows{RowKind::kEdge, "edges"}, kPathRows{RowKind::kPath, "path"};

/// What the rows of a map were when its last drive began, in the table `undo` of the map: each older row is
/// kept once, when it first changes. A drive that was cut off can so be taken back as a whole, which is how
/// it is resumed.
class Undo {
 public:
  /// Starts with a state to go back to.
  void begin(Connection& database, const MapState& base);
  /// Goes on with what the file holds; false when it holds none.
  bool load(Connection& database);
  /// Forgets everything: the drive is over.
  void clear(Connection& database);

  /// To be called before a row changes or goes.
  void keep(Connection& database, const RowTable& table, std::uint64_t id);
  void keepAll(Connection& database, const RowTable& table);
  /// The transaction that the last calls belong to was committed, or was not.
  void settle(bool committed);

  /// Brings all rows back to what they were. The records of images stay.
  /// Throws base::Error when the file holds nothing to go back to. Returns the state to go back to.
  static MapState takeBack(Connection& database);

 private:
  /// Rows from this number on are of this drive.
  std::uint64_t firstNew(RowKind kind) const;

  bool active_ = false;
  MapState base_;
  std::set<std::pair<RowKind, std::uint64_t>> kept_;
  std::vector<std::pair<RowKind, std::uint64_t>> unsettled_;
};

}  // namespace engram::store

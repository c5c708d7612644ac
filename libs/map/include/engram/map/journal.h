// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace engram::map {

/// How far a reader has read the changes of a map. One that starts from the default reads all that happened
/// since the map was made or read from a file; TopologicalMap::now() skips that.
struct Cursor {
  std::uint64_t sequence = 0;
  std::size_t pathSize = 0;  ///< path points known already
};

/// Ids of what changed in a map since a cursor. Ascending, without duplicates.
struct MapChanges {
  std::vector<base::PlaceId> places;         ///< new, moved, surveyed or of another standing
  std::vector<base::PlaceId> memories;       ///< new or updated
  std::vector<base::ViewId> views;           ///< new
  std::vector<base::EdgeId> edges;           ///< new, or correspondences dropped
  std::vector<base::PlaceId> removedPlaces;  ///< with their memories
  std::vector<base::ViewId> removedViews;
  std::vector<base::EdgeId> removedEdges;
  std::vector<std::size_t> movedPathPoints;  ///< older ones that are tied to another place now
  bool pathForgotten = false;  ///< older path points are gone: the others have new numbers and are all new
  std::size_t firstNewPathPoint = 0;  ///< path points from here on are new
  std::size_t pathSize = 0;           ///< path points in all
  bool empty() const;
};

/// The changes of a map in their order, for any number of readers. It holds the last change of each thing
/// alone, so it never outgrows the map and what was removed from it, and reading costs what has changed. A
/// value: a copy of a map is read on with the cursors of the original.
class Journal {
 public:
  enum class Kind : std::uint8_t {
    kPlace,
    kMemory,
    kView,
    kEdge,
    kRemovedPlace,
    kRemovedView,
    kRemovedEdge,
    kMovedPathPoint,
    kForgottenPath,
  };

  void note(Kind kind, std::size_t id = 0);
  /// The thing is gone, and so is what was noted of it.
  void drop(Kind kind, std::size_t id);

  std::uint64_t now() const { return now_; }
  /// What was noted after `sequence`; of the path only `movedPathPoints` and `pathForgotten`.
  MapChanges since(std::uint64_t sequence) const;

 private:
  using Key = std::pair<Kind, std::size_t>;
  struct Entry {
    std::uint64_t sequence;
    Key key;
  };
  void compact();

  std::uint64_t now_ = 0;
  std::vector<Entry> entries_;  // rising; those that `latest_` does not name are outdated
  std::map<Key, std::uint64_t> latest_;
};

}  // namespace engram::map

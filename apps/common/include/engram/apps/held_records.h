// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/store/map_file.h"
#include "engram/types/frame_report.h"

#include <optional>
#include <vector>

namespace engram::apps {

/// Keeps the records of a drive back until an image is of use. So a run of which no image can be used makes
/// no map, does not replace one, and leaves the one that it extends as it was.
class HeldRecords {
 public:
  /// Takes the record of the next image. True when there is something to commit: from the first image on that
  /// could be used, or when 4096 wait in vain, for memory is finite.
  bool due(const types::FrameReport& report);
  /// Commits all that is due, with what the map has changed.
  void commitTo(store::MapFile& file, map::TopologicalMap& map);
  /// Of the first image of the drive [s].
  double firstStamp() const { return firstStamp_.value_or(0.0); }

 private:
  std::vector<types::FrameReport> held_;
  std::optional<double> firstStamp_;
  bool useful_ = false;
};

}  // namespace engram::apps

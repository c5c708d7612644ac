// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/store/drive.h"
#include "engram/store/map_file.h"
#include "engram/store/writer_lock.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace engram::store {

/// What a run may do with its map.
struct DriveOptions {
  bool extend = false;     ///< the map must exist; the drive is added to it
  bool overwrite = false;  ///< a map that exists is replaced
  bool resume = false;     ///< go on with a drive that was cut off, if this is one
  bool again = false;      ///< a drive that the map has learnt may be learnt once more
};

/// One drive on its way into a map, image by image. The map is locked from the constructor on.
///
/// A drive that was cut off is resumed by going over its images once more on the map as it was before: the
/// same input gives the same decisions, which is compared. From the first new image on, images are committed.
class DriveWriter {
 public:
  /// @param source name of the rawlog or camera, for messages
  /// @param first the first image of the drive; needed to resume
  /// Throws base::Error when the map exists and may not be touched, does not exist and should, is being
  /// written by another program, or when there is another drive to resume than this one.
  DriveWriter(const std::string& path, const DriveOptions& options, std::string source,
              const types::Frame* first = nullptr);

  /// The whole drive is in the map already: nothing is to be done.
  bool complete() const { return complete_; }
  /// Images of this drive that the map holds already.
  std::uint64_t known() const { return recorded_.size(); }
  /// Of the map on the disk; null for a new one.
  const map::MapHeader* header() const { return file_ ? &file_->header() : nullptr; }
  /// The map that the drive begins with.
  map::TopologicalMap load();

  /// The path and the records of older drives were forgotten in this map: so they are in the file.
  void forget(const map::TopologicalMap& map, int firstKeptSession);
  /// What the map shall say of this drive beside its source. To be called before begin().
  void note(std::string text) { note_ = std::move(text); }
  /// To be called with the first image, before it changes the map. The file is made or changed by the first
  /// image that is of use: a run without any leaves it as it is.
  /// @param header for a new map
  /// Throws base::Error when the map has learnt this drive already.
  void begin(const types::Frame& first, int session, const map::MapHeader& header);
  /// The map has learnt one more image. Throws base::Error when it is not what was recorded of it.
  void add(const map::TopologicalMap& map, const types::FrameReport& report);
  /// Whether the last add() was of an image that the map had held already.
  bool replayed() const { return added_ <= recorded_.size(); }
  /// @param whole all images were there; otherwise the drive can be resumed
  void end(const map::TopologicalMap& map, bool whole);

  /// What was worked out of the map lies beside it from now on. To be called after end().
  void keep(std::span<const map::DerivedRow> rows);

  /// Says where the drive goes on since the server of its map went away, and how to bring it back: a map file
  /// in the current folder, with all that is known. Empty as long as the server is there.
  std::string notice() const;
  /// After begin(), or for a map that exists.
  MapFile& file() { return *file_; }

 private:
  void openExisting(const types::Frame* first);
  void commit(const map::TopologicalMap& map, const types::FrameReport& report);
  void write(const map::TopologicalMap& map, const types::FrameReport& report);
  void goOnInSpool(const map::TopologicalMap& map, const types::FrameReport* report);
  void requireNew(std::uint32_t fingerprint) const;

  std::string path_, source_, spool_, note_;
  DriveOptions options_;
  std::optional<WriterLock> lock_;  // until there is a file that holds it; of a file alone
  std::optional<MapFile> file_;
  map::Cursor stored_;  // changes up to here are in the file
  map::MapHeader newHeader_;
  std::optional<Drive> next_;             // to begin
  std::vector<types::FrameReport> held_;  // of its images so far
  bool resumes_ = false, complete_ = false;
  std::vector<types::FrameReport> recorded_;  // of the drive that is resumed
  std::uint64_t added_ = 0;
  std::vector<Drive> drives_;  // of a map on a server, as far as it knows them
};

}  // namespace engram::store

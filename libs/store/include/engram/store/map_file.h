// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/map_content.h"
#include "engram/map/topological_map.h"
#include "engram/store/drive.h"
#include "engram/store/feature_counts.h"
#include "engram/store/whole_map.h"
#include "engram/store/writer_lock.h"
#include "engram/types/frame_report.h"

#include <cstdint>
#include <iosfwd>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace engram::store {

/// Version of the file format that this program writes, and the newest that it reads.
inline constexpr int kFormatVersion = 3;

enum class Access { kReadOnly, kReadWrite };

/// A map in one SQLite file, or on a PostgreSQL server where `path` is `postgresql://host/db?map=name`: the
/// same rows in the same tables. Every row carries a CRC-32, every commit is one transaction.
///
/// One program at a time may write a map: create() and open() for writing take the WriterLock and keep it.
/// While it writes, a file `<path>-wal` beside the map holds the latest commits: what was committed is there
/// again after the process was killed. close() folds it into the one file. A reader sees the map as it was
/// when it was opened and changes no byte of it; a map that was opened for writing keeps every byte until
/// something is written. All errors are base::Error, name the file and say what to do.
class MapFile {
 public:
  /// Refuses a path that exists, unless `overwrite` is given and the file there is a map or empty.
  static MapFile create(const std::string& path, const map::MapHeader& header, bool overwrite = false);
  /// The same with the lock that the program has held since its start.
  static MapFile create(WriterLock lock, const map::MapHeader& header, bool overwrite = false);
  static MapFile open(const std::string& path, Access access);
  /// Whether there is something at a path, or a map at the address of a server.
  static bool exists(const std::string& path);

  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;
  ~MapFile();

  const std::string& path() const;
  const map::MapHeader& header() const;

  /// Reads and checks everything.
  map::TopologicalMap load() const;
  /// The same, but what places remember stays in the file until it is asked for, and is checked then; and
  /// MapContent::derived reads what is kept beside the map. The map may outlive this object.
  map::TopologicalMap loadOnDemand();
  /// The same without the views.
  map::TopologicalMap loadGraph();
  /// A reader whose map is in the file still keeps others from writing it. To be called now and then: when a
  /// program wants to write the map, this takes along what was not read yet, and lets go of the file.
  void yieldToWriter();

  /// Writes what changed and the record of the image, or nothing at all if it throws.
  void commit(const map::TopologicalMap& map, const map::MapChanges& changes,
              const types::FrameReport* report = nullptr);
  /// The same with the records of several images.
  void commit(const map::TopologicalMap& map, const map::MapChanges& changes,
              std::span<const types::FrameReport> reports);

  /// Keeps rows beside the map, and with them how much its places remember. They are no part of it: dump()
  /// does not show them.
  void keep(std::span<const map::DerivedRow> rows);

  /// All runs that wrote into the map; none of a map of format 1 that was not written since.
  std::vector<Drive> drives() const;
  /// The commits from now on are of this drive; its number and counts are set here.
  void beginDrive(Drive drive);
  /// The drive is complete; it cannot be taken back any more.
  void endDrive();
  /// The map as it was when its last drive began. Throws base::Error when that drive is complete.
  map::TopologicalMap loadBeforeLastDrive();
  /// Goes on with the last drive. `map` and `changes` are those of the drive begun anew on
  /// loadBeforeLastDrive(): they replace all that it wrote, but for the records.
  void resumeDrive(const map::TopologicalMap& map, const map::MapChanges& changes);

  /// Drops the records of all drives before the one that made this session's path.
  void forgetRecords(int firstKeptSession);

  /// Read without the memories, but for those of which it is not kept beside the map.
  FeatureCounts featureCounts() const;
  std::uint64_t recordCount() const;
  std::uint64_t viewCount() const;
  /// What keepers have laid down, by name.
  std::map<std::string, std::string> notes() const;
  /// All that the map holds.
  WholeMap whole() const;
  /// Makes the map hold this and nothing else, in one transaction. Numbers that were used stay used. A drive
  /// that was cut off cannot be resumed afterwards. Throws base::Error when it breaks a rule of maps.
  void replace(const WholeMap& whole);

  /// The records of all images, in the order of the commits.
  std::vector<types::FrameReport> records() const;

  /// Everything that is wrong with the file, one sentence each; empty when it is sound.
  std::vector<std::string> check() const;

  /// The whole content as text, one item a line, numbers exact. Equal maps give equal text: wall times are
  /// left out.
  void dump(std::ostream& out) const;

  /// Size on disk, with commits not yet folded in; after close() that of the closed map [bytes].
  std::uint64_t bytes() const;

  /// Makes it one file again. The destructor does the same, but cannot report a failure.
  void close();

 private:
  struct Impl;
  class Edit;
  explicit MapFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Throws base::ConfigError when a map made with `stored` cannot be used with `wanted`: other camera,
/// extractor, descriptor or memory model. Parameters may differ. `path` is for the message.
void requireCompatible(const map::MapHeader& stored, const map::MapHeader& wanted, const std::string& path);

const char* toString(types::DescriptorKind kind);

/// MapFile::dump() of values in memory.
void dump(std::ostream& out, const map::MapHeader& header, const map::MapContent& content,
          const std::vector<types::FrameReport>& records, const std::vector<Drive>& drives = {});

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/map_content.h"
#include "engram/map/topological_map.h"
#include "engram/types/frame_report.h"

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace engram::store {

/// Version of the file format that this program writes, and the newest that it reads.
inline constexpr int kFormatVersion = 1;

enum class Access { kReadOnly, kReadWrite };

/// A map in one SQLite file. Every row carries a CRC-32, every commit is one transaction.
///
/// While a writer has the file open, a file `<path>-wal` beside it holds the latest commits: what was
/// committed is there again after the process was killed. close() folds it into the one file. A reader
/// changes no byte of the map. All errors are base::Error, name the file and say what to do.
class MapFile {
 public:
  /// Refuses a path that exists, unless `overwrite` is given and the file there is a map or empty.
  static MapFile create(const std::string& path, const map::MapHeader& header, bool overwrite = false);
  static MapFile open(const std::string& path, Access access);

  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;
  ~MapFile();

  const std::string& path() const;
  const map::MapHeader& header() const;

  /// Reads and checks everything.
  map::TopologicalMap load() const;

  /// Writes what changed and the record of the image, or nothing at all if it throws.
  void commit(const map::TopologicalMap& map, const map::MapChanges& changes,
              const types::FrameReport* report = nullptr);

  /// Drops the records of all images that were taken before this time [s].
  void forgetRecords(double before);

  /// The records of all images, in the order of the commits.
  std::vector<types::FrameReport> records() const;

  /// Everything that is wrong with the file, one sentence each; empty when it is sound.
  std::vector<std::string> check() const;

  /// The whole content as text, one item a line, numbers exact. Equal maps give equal text: wall times are
  /// left out.
  void dump(std::ostream& out) const;

  /// Size on disk, with commits not yet folded in [bytes].
  std::uint64_t bytes() const;

  /// Makes it one file again. The destructor does the same, but cannot report a failure.
  void close();

 private:
  struct Impl;
  explicit MapFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Throws base::ConfigError when a map made with `stored` cannot be used with `wanted`: other camera,
/// extractor, descriptor or memory model. Parameters may differ. `path` is for the message.
void requireCompatible(const map::MapHeader& stored, const map::MapHeader& wanted, const std::string& path);

const char* toString(types::DescriptorKind kind);

/// MapFile::dump() of values in memory.
void dump(std::ostream& out, const map::MapHeader& header, const map::MapContent& content,
          const std::vector<types::FrameReport>& records);

}  // namespace engram::store

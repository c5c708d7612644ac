// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/store/writer_lock.h"

#include <filesystem>
#include <string>

namespace engram::store {

/// A map that is made beside its place, and comes there as a whole or not at all. Its place is locked.
class NewMap {
 public:
  /// Throws base::Error when `path` exists, unless `overwrite` is given and it is a map, and when it is being
  /// written.
  NewMap(const std::string& path, bool overwrite);
  ~NewMap();
  NewMap(const NewMap&) = delete;
  NewMap& operator=(const NewMap&) = delete;

  /// Where to write it.
  std::string file() const { return (folder_ / "map").string(); }
  /// A name for another file that goes with this object.
  std::string scratch() const { return (folder_ / "work").string(); }
  /// To be called when it is closed.
  void publish();

 private:
  std::string path_;
  WriterLock lock_;
  std::filesystem::path folder_;
};

/// Throws base::Error unless the map exists and is a file, and another one than `to`.
void requireSource(const std::string& from, const std::string& to);

/// The files of a map that nobody writes, under another name.
void copyFiles(const std::string& from, const std::string& to);

/// `from`, or a copy of its files at `scratch` when its log cannot be read where it is.
std::string readablePath(const std::string& from, const std::string& scratch);

/// All that the map at `from` holds at one moment, into a file that does not exist.
void copyContent(const std::string& from, const std::string& to);

}  // namespace engram::store

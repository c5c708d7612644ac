// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace engram::store {

/// Where the files beside a map are: behind a link they are beside what it leads to.
std::string realPath(const std::string& path);

/// The first bytes of a map file, read without SQLite.
struct FileHead {
  std::uint64_t bytes = 0;          ///< of the whole file
  std::uint64_t declaredBytes = 0;  ///< that its header speaks of
  bool logged = false;              ///< its latest commits are in a log beside it
  bool hasTables = false;           ///< false as long as everything is in the log
  std::uint32_t applicationId = 0;
};

/// Nothing unless the file begins like one of SQLite.
std::optional<FileHead> readHead(const std::string& path);

/// The file says that its latest commits are in a log, and there is none, nor a program that writes it.
bool logIsMissing(const std::string& path);

/// True for a map, also a damaged one, one that crashed before its first commit was folded in, and an empty
/// file: what may be overwritten when that is asked for.
bool looksLikeMap(const std::string& path);

/// The cause of an error code of SQLite and what to do, for a map at `path`.
std::string explanation(int code, int systemError, const std::string& path);

/// Why a file that opens as a database is no map.
std::string whyNoMap(const std::string& path);

}  // namespace engram::store

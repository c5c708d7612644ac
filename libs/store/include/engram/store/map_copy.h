// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace engram::store {

/// A whole copy of a map as it is at this moment, also while a program writes it, and of one that crashed
/// with its log beside it. Written beside `to` and renamed. Throws base::Error when the map is damaged, and
/// when `to` exists, unless `overwrite` is given and it is a map.
void copyMap(const std::string& from, const std::string& to, bool overwrite = false);

/// What recoverMap() saved.
struct Recovery {
  std::uint64_t places = 0, views = 0, edges = 0, path = 0, records = 0;
  std::vector<std::string> lost;  ///< what was not, one phrase a kind; empty when the map was whole
};

/// A new map of whatever can be read of a damaged one, which is not changed. Only what is as it was written
/// is kept; what hangs on lost things goes too, so that the new map is sound. Throws base::Error when nothing
/// can be recovered, and for `to` as copyMap() does.
Recovery recoverMap(const std::string& from, const std::string& to, bool overwrite = false);

/// Says so when the last commits of a map may be missing because its log is; otherwise empty.
std::string missingLog(const std::string& path);

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "database.h"
#include "engram/base/error.h"
#include "engram/store/map_copy.h"
#include "engram/store/map_file.h"
#include "scratch.h"

namespace engram::store {

void copyMap(const std::string& from, const std::string& to, bool overwrite) {
  requireSource(from, to);
  NewMap target(to, overwrite);
  copyContent(readablePath(from, target.scratch()), target.file());
  Database(target.file(), Database::Mode::kReadWrite).foldLog();
  // A damaged copy must not replace a good one.
  const auto problems = MapFile::open(target.file(), Access::kReadOnly).check();
  if (!problems.empty())
    throw base::Error("map '" + from + "' is damaged: " + problems.front() +
                      ". It was not copied; save what can be read with 'engram-map recover'");
  target.publish();
}

}  // namespace engram::store

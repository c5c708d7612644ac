// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/store/whole_map.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <iosfwd>
#include <string>

namespace engram::apps {

/// What all commands that change a map share: the change is one transaction, the map before it is copied
/// beside it, and `--dry-run` says what would be done.
class EditCommand {
 public:
  void declare(CLI::App& command);

  /// @param change makes the change, says to `out` what it did, and returns whether there was any
  /// @returns an exit code: that of nothing to do is 0
  int run(std::ostream& out, std::ostream& err,
          const std::function<bool(store::WholeMap&, std::ostream& out)>& change) const;

  const std::string& map() const { return map_; }
  /// A free name for a copy of a map before a change: a file beside it, or here for one on a server.
  static std::string undoPathOf(const std::string& map);

 private:
  std::string map_, undo_;
  bool dryRun_ = false, quiet_ = false;
};

}  // namespace engram::apps

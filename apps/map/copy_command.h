// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <string>

namespace engram::apps {

/// engram-map copy and recover: a new map from one that is not changed.
class CopyCommand {
 public:
  enum class Kind { kCopy, kRecover };
  explicit CopyCommand(Kind kind) : kind_(kind) {}

  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  int recover(std::ostream& out);

  Kind kind_;
  std::string from_, to_;
  bool overwrite_ = false, quiet_ = false;
};

/// Prints a warning when the last images of a map may be missing.
void printMissingLog(const std::string& map, std::ostream& err);

}  // namespace engram::apps

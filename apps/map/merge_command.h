// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/store/map_file.h"

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <string>

namespace engram::apps {

/// engram-map merge: two maps of one building become a third.
class MergeCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  std::string write(store::MapFile& file, const store::WholeMap& merged) const;

  std::string a_, b_, out_, json_;
  bool into_ = false, overwrite_ = false, dryRun_ = false, quiet_ = false;
};

}  // namespace engram::apps

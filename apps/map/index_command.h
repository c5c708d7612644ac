// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <string>

namespace engram::apps {

/// engram-map index: lays beside a map what the next program to open it would have to work out.
class IndexCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out) const;

 private:
  std::string map_;
  bool quiet_ = false;
};

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <string>

namespace engram::apps {

/// engram-map diff: what two maps have in common, and what not.
class DiffCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out);

 private:
  std::string a_, b_, json_;
  bool all_ = false, quiet_ = false;
};

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>

namespace engram::base {

/// True when the stream is one of the process's own and goes to a terminal.
bool isTerminal(const std::ostream& out);

/// One line on a terminal, rewritten in place: what, share done, rate and time left. On a file or pipe it
/// prints a line every ten seconds. Silent when `out` is null.
class Progress {
 public:
  Progress(std::ostream* out, std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `fraction` in [0, 1], negative when unknown; `items` done so far.
  void update(double fraction, std::size_t items);
  /// Removes the line; called by the destructor too.
  void finish();

 private:
  std::ostream* out_;
  std::string what_;
  bool isTerminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace engram::base

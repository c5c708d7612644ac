// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace engram::base {

/// Makes Ctrl-C, SIGTERM and SIGHUP set a flag instead of ending the process, so that a program can finish
/// the image at hand, commit and report. A second signal ends it at once, if it comes more than half a second
/// after the first: `timeout` signals the process and then its group, and means one signal. Never a second
/// SIGHUP, as a terminal that closes sends several. What `nohup` ignores stays ignored.
void installInterruptHandler();

/// True once a signal came.
bool interrupted();

/// Thrown by long work that stops because interrupted() is true. Programs exit with 3: what was done is kept.
class Interrupted : public std::runtime_error {
 public:
  /// @param doing what was stopped: "recording the drives"
  explicit Interrupted(const std::string& doing) : std::runtime_error("interrupted while " + doing) {}
};

}  // namespace engram::base

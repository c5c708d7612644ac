// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace engram::testing {

/// One of the programs in a process of its own, with standard descriptors of our choice.
struct ProgramProcess {
  static constexpr int kClosed = -1;  ///< started without it

  std::vector<std::string> command;  ///< name of the program, then its arguments
  int out = kClosed, err = kClosed;

  pid_t start() const {
    std::vector<std::string> words = command;
    words[0] = ENGRAM_BIN_DIR "/" + words[0];
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t child = ::fork();
    if (child != 0) return child;
    ::signal(SIGPIPE, SIG_DFL);
    place(out, STDOUT_FILENO);
    place(err, STDERR_FILENO);
    ::execv(arguments[0], arguments.data());
    std::_Exit(127);
  }

  /// Runs it; returns the status of waitpid().
  int run() const {
    int status = -1;
    ::waitpid(start(), &status, 0);
    return status;
  }

 private:
  static void place(int from, int to) {
    if (from == kClosed)
      ::close(to);
    else
      ::dup2(from, to);
  }
};

}  // namespace engram::testing

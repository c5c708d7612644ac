// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace engram::testing {

/// A program as our own child, ended with this object.
class ChildProcess {
 public:
  explicit ChildProcess(const std::vector<std::string>& command) {
    std::vector<char*> arguments;
    for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    execvp(arguments[0], arguments.data());
    std::_Exit(127);
  }
  ~ChildProcess() { end(SIGTERM); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  bool running() {
    if (pid_ > 0 && waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = -1;
    return pid_ > 0;
  }
  /// Sends a signal, waits for the end and returns the status of waitpid().
  int end(int signal) {
    if (pid_ > 0) {
      kill(pid_, signal);
      waitpid(pid_, &status_, 0);
    }
    pid_ = -1;
    return status_;
  }

 private:
  pid_t pid_ = -1;
  int status_ = -1;
};

/// Aravis' simulated camera on the loopback interface. Only one at a time: tests that use it hold the lock
/// `gv_port` of ctest.
class FakeCameraProcess : public ChildProcess {
 public:
  FakeCameraProcess() : ChildProcess({"arv-fake-gv-camera-0.8", "-i", "127.0.0.1"}) {}
};

}  // namespace engram::testing

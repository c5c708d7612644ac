// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/interrupt.h"

#include <csignal>
#include <ctime>

namespace engram::base {
namespace {

constexpr double kSameSignalSeconds = 0.5;

volatile std::sig_atomic_t signalled = 0;
timespec firstSignal{};  // when `signalled` was set

double secondsSinceFirstSignal() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);  // may be called from a handler (POSIX)
  return static_cast<double>(now.tv_sec - firstSignal.tv_sec) +
         1e-9 * static_cast<double>(now.tv_nsec - firstSignal.tv_nsec);
}

extern "C" void onSignal(int number) {
  if (!signalled) {
    ::clock_gettime(CLOCK_MONOTONIC, &firstSignal);
    signalled = 1;
  } else if (secondsSinceFirstSignal() > kSameSignalSeconds) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}

extern "C" void onHangUp(int) { signalled = 1; }

bool isIgnored(int number) {
  struct sigaction action {};
  return ::sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void installInterruptHandler() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  if (!isIgnored(SIGHUP)) std::signal(SIGHUP, onHangUp);  // nohup
}

bool interrupted() { return signalled != 0; }

}  // namespace engram::base

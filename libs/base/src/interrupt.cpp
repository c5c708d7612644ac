// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/interrupt.h"

#include <csignal>

namespace engram::base {
namespace {

volatile std::sig_atomic_t signalled = 0;

extern "C" void onSignal(int number) {
  if (signalled) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
  signalled = 1;
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

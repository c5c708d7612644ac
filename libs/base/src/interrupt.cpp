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

}  // namespace

void installInterruptHandler() {
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
}

bool interrupted() { return signalled != 0; }

}  // namespace engram::base

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/progress.h"

#include <cstdio>
#include <iostream>
#include <unistd.h>

namespace engram::base {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

std::string describe(const std::string& what, double fraction, std::size_t items, double elapsed) {
  char text[160];
  const double rate = elapsed > 0 ? static_cast<double>(items) / elapsed : 0.0;
  if (fraction > 0.0) {
    const double left = elapsed * (1.0 - fraction) / fraction;
    std::snprintf(text, sizeof text, "%s: %3.0f %%, %zu images, %.1f/s, %.0f s left", what.c_str(),
                  100.0 * fraction, items, rate, left);
  } else {
    std::snprintf(text, sizeof text, "%s: %zu images, %.1f/s", what.c_str(), items, rate);
  }
  return text;
}

}  // namespace

bool isTerminal(const std::ostream& out) {
  if (&out == &std::cerr || &out == &std::clog) return ::isatty(STDERR_FILENO) != 0;
  return &out == &std::cout && ::isatty(STDOUT_FILENO) != 0;
}

Progress::Progress(std::ostream* out, std::string what)
    : out_(out),
      what_(std::move(what)),
      isTerminal_(out != nullptr && isTerminal(*out)),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() { finish(); }

void Progress::update(double fraction, std::size_t items) {
  if (!out_) return;
  const auto now = Clock::now();
  if (seconds(now - last_) < (isTerminal_ ? 0.2 : 10.0)) return;
  last_ = now;
  shown_ = true;
  const std::string line = describe(what_, fraction, items, seconds(now - start_));
  *out_ << (isTerminal_ ? "\r\x1b[K" + line : line + "\n") << std::flush;
}

void Progress::finish() {
  if (out_ && shown_ && isTerminal_) *out_ << "\r\x1b[K" << std::flush;
  out_ = nullptr;
}

}  // namespace engram::base

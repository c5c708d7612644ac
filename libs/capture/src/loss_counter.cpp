// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "loss_counter.h"

#include <utility>

namespace engram::capture {
namespace {

constexpr std::uint64_t kLast16 = 65535;
constexpr std::uint64_t kHalf = 1 << 15;  // a leap by more is no loss but a camera that counts anew

/// How many numbers on from `last` is `number`? 0 when it is none: repeated, late, or counted anew.
std::uint64_t steps(std::uint64_t last, std::uint64_t number) {
  if (number > last) return number - last <= kHalf ? number - last : 0;
  if (number == last || last > kLast16 || last < kHalf || number > kHalf) return 0;
  return kLast16 - last + (number == 0 ? 1 : number);
}

}  // namespace

std::size_t LossCounter::whole(std::uint64_t number) {
  ++whole_;
  const std::uint64_t step = last_ ? steps(*last_, number) : 1;
  last_ = number;
  const std::size_t seen = std::exchange(incompleteSince_, 0);
  if (step <= 1 + seen) return 0;
  missed_ += step - 1 - seen;
  return step - 1 - seen;
}

void LossCounter::incomplete() {
  ++incomplete_;
  ++incompleteSince_;
}

}  // namespace engram::capture

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/stamp_gate.h"

#include <cmath>

namespace engram::sources {

StampGate::Verdict StampGate::check(double stamp) {
  if (std::isnan(last_) || (stamp > last_ && stamp - last_ <= kMaxJump)) {
    last_ = stamp;
    refusedInARow_ = 0;
    return Verdict::kPass;
  }
  if (stamp == last_ || (refusedInARow_ > 0 && stamp == refused_)) return Verdict::kRepeated;
  const bool consistent = refusedInARow_ > 0 && stamp > refused_ && stamp - refused_ <= kMaxJump;
  if (!consistent) firstRefused_ = stamp;
  refusedInARow_ = consistent ? refusedInARow_ + 1 : 1;
  refused_ = stamp;
  if (refusedInARow_ > (firstRefused_ > last_ ? kPatienceAhead : kPatience)) {
    jump_ = firstRefused_ - last_;
    last_ = stamp;
    refusedInARow_ = 0;
    return Verdict::kRestart;
  }
  return stamp < last_ ? Verdict::kBackwards : Verdict::kJump;
}

}  // namespace engram::sources

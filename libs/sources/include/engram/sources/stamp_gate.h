// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>

namespace engram::sources {

/// Lets only rising stamps pass. One wild stamp does not lock out all that follow: when several refused ones
/// in a row rise among themselves, it is the reference that was wrong (or the clock was set), and time starts
/// anew there.
class StampGate {
 public:
  enum class Verdict { kPass, kRepeated, kBackwards, kJump, kRestart };

  /// kPass and kRestart: use the sample. The others: leave it out.
  Verdict check(double stamp);

  double last() const { return last_; }  ///< stamp that passed last [s]; NaN before the first
  /// How many of the last stamps that were refused belong together: the next ones may show that they were
  /// right.
  int inDoubt() const { return refusedInARow_; }
  /// How far time jumped at the last kRestart [s]: from the stamp that had passed before to the first one in
  /// doubt.
  double jump() const { return jump_; }

 private:
  static constexpr double kMaxJump = 366.0 * 86400.0;  // [s]
  static constexpr int kPatience = 10;
  static constexpr int kPatienceAhead =
      2;  // a clock that gets the time from the network leaps ahead for good
  double last_ = std::numeric_limits<double>::quiet_NaN();
  double refused_ = std::numeric_limits<double>::quiet_NaN();
  double firstRefused_ = 0.0, jump_ = 0.0;
  int refusedInARow_ = 0;
};

}  // namespace engram::sources

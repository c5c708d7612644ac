// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/stamp_gate.h"

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace engram::sources {

/// What StampQueue made of the stamps.
struct StampCounts {
  std::size_t bad = 0;       ///< refused
  std::size_t leaps = 0;     ///< of them, those that leapt ahead by more than a year
  std::size_t setBack = 0;   ///< times that the clock was set back for good
  std::size_t setAhead = 0;  ///< times that it leapt ahead for good
};

/// Lets items with rising stamps pass, in the order they came. One whose stamp is in doubt (see StampGate) is
/// held back until the next ones tell; when the clock was set none is lost. What passes passes a second queue
/// entirely.
template <class T>
class StampQueue {
 public:
  struct Passed {
    double stamp = 0.0;  ///< [s]
    T item;
    bool restart = false;  ///< time starts anew here
  };

  void push(double stamp, T item) {
    const auto verdict = gate_.check(stamp);
    Passed passed{stamp, std::move(item), false};
    if (verdict == StampGate::Verdict::kPass) {
      refuseDoubtful();
      passed_.push_back(std::move(passed));
    } else if (verdict == StampGate::Verdict::kRestart) {
      ++(gate_.jump() > 0 ? counts_.setAhead : counts_.setBack);
      doubtful_.push_back(std::move(passed));
      doubtful_.front().restart = true;
      for (auto& each : doubtful_) passed_.push_back(std::move(each));
      doubtful_.clear();
    } else if (verdict == StampGate::Verdict::kRepeated) {
      ++counts_.bad;
    } else {
      if (gate_.inDoubt() == 1) refuseDoubtful();
      doubtful_.push_back(std::move(passed));
    }
  }

  /// The next one that passed.
  std::optional<Passed> pop() {
    if (passed_.empty()) return std::nullopt;
    Passed front = std::move(passed_.front());
    passed_.pop_front();
    return front;
  }

  /// No more come: what is in doubt is refused.
  void finish() { refuseDoubtful(); }

  double last() const { return gate_.last(); }  ///< stamp that passed last [s]; NaN before the first
  const StampCounts& counts() const { return counts_; }

 private:
  void refuseDoubtful() {
    counts_.bad += doubtful_.size();
    for (const auto& each : doubtful_) counts_.leaps += each.stamp > gate_.last() ? 1 : 0;
    doubtful_.clear();
  }

  StampGate gate_;
  std::deque<Passed> passed_;
  std::vector<Passed> doubtful_;
  StampCounts counts_;
};

}  // namespace engram::sources

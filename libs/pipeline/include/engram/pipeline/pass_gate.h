// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/ids.h"
#include "engram/memory/models.h"

namespace engram::pipeline {

/// update_policy of D-E3: with `per_pass` a place that has learnt learns again only after another place was
/// accepted, or a new session began.
class PassGate {
 public:
  explicit PassGate(const memory::MemoryParams& params) : perPass_(params.update_policy == "per_pass") {}

  /// To be called for every accepted place, new ones included, whether it then learns or not.
  void accepted(base::PlaceId place) {
    if (place == here_) return;
    here_ = place;
    hasLearnt_ = false;
  }
  /// May the place accepted last learn now?
  bool open() const { return !perPass_ || !hasLearnt_; }
  /// The place accepted last has learnt, or was made.
  void learnt() { hasLearnt_ = true; }
  /// The session has ended.
  void restart() { accepted({}); }

 private:
  bool perPass_;
  base::PlaceId here_;
  bool hasLearnt_ = false;
};

}  // namespace engram::pipeline

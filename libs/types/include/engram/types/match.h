// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace engram::types {

/// Feature `a` of a first set corresponds to feature `b` of a second one.
struct Match {
  int a = -1;
  int b = -1;
  float distance =
      0;  ///< descriptor distance: L2 of unit vectors in [0, 2], or share of differing bits in [0, 1]
  bool operator==(const Match&) const = default;
};

}  // namespace engram::types

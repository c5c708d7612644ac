// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace engram::store {

/// What all places of a map remember together.
struct FeatureCounts {
  std::uint64_t longTerm = 0, shortTerm = 0;
};

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"

namespace engram::testing {

/// The map that tinyParams() makes of firstDrive(). Made once per test binary.
const map::TopologicalMap& firstMap();

}  // namespace engram::testing

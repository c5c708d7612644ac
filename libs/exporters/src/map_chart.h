// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"

#include <string>

namespace engram::exporters {

/// The map seen from above: edges by type, paths by session, places by the number of long-term features.
std::string mapChart(const map::TopologicalMap& map);

}  // namespace engram::exporters

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/charts/colours.h"
#include "engram/map/map_content.h"

#include <array>

namespace engram::exporters {

charts::Colour edgeColour(map::EdgeType type);

/// All kinds of edges, in the order of legends.
inline constexpr std::array kEdgeTypes{map::EdgeType::kOdometry,    map::EdgeType::kLoop,
                                       map::EdgeType::kRecognition, map::EdgeType::kWeak,
                                       map::EdgeType::kCompounded,  map::EdgeType::kDeadReckoning};

/// Largest number of long-term features of any place, at least 1.
int largestLongTerm(const map::MapContent& content);

}  // namespace engram::exporters

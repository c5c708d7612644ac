// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/graph.h"

#include <mrpt/graphs/CNetworkOfPoses.h>

namespace engram::posegraph {

/// The graph as MRPT's type, for its solvers, files and viewers. Information is expressed in MRPT's
/// coordinates (x, y, z, yaw, pitch, roll) of the relative pose. Constraints without scale have no such form
/// and are left out. Near pitch = ±90° the coordinates are singular and the information is that at 89.9°.
mrpt::graphs::CNetworkOfPoses3DInf toMrpt(const Graph& graph);

/// The reverse. Node numbers are place ids. No constraint is robust.
Graph fromMrpt(const mrpt::graphs::CNetworkOfPoses3DInf& network);

}  // namespace engram::posegraph

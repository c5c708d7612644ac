// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/relaxer.h"

#include <set>

namespace engram::posegraph {

std::unique_ptr<Relaxer> makeCeresRelaxer(const RelaxerParams& params);
std::unique_ptr<Relaxer> makeMrptRelaxer(const RelaxerParams& params);

/// The first place of every connected part: those that stay where they are.
std::set<PlaceId> anchors(const Graph& graph);

}  // namespace engram::posegraph

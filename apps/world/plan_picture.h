// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/world/world.h"

#include <opencv2/core/mat.hpp>

namespace engram::apps {

/// The building from above: walls, doors, windows, furniture of a session, and the tour with its numbered
/// stations.
cv::Mat drawPlan(const world::World& world, const world::Appearance& appearance);

}  // namespace engram::apps

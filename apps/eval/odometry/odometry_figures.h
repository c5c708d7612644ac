// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "engram/evaluation/drift.h"
#include "odometry/odometry_run.h"

#include <string>

namespace engram::apps {

/// One row a frame: index, stamp, reason, counts, times.
ResultTable tableOf(const std::vector<OdometryFrame>& frames);

/// @param drift not measured: without truth.
nlohmann::json figuresJson(const OdometryDrive& drive, const evaluation::Drift& drift);
std::string figuresText(const OdometryDrive& drive, const evaluation::Drift& drift);
nlohmann::json toJson(const odometry::StereoHealth& health);

}  // namespace engram::apps

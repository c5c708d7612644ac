// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/drift.h"
#include "odometry/odometry_run.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace engram::apps {

/// One line a frame: index, stamp, reason, counts, times.
std::string framesCsv(const OdometryDrive& drive);

/// @param drift not measured: without truth.
nlohmann::json figuresJson(const OdometryDrive& drive, const evaluation::Drift& drift);
std::string figuresText(const OdometryDrive& drive, const evaluation::Drift& drift);
nlohmann::json toJson(const odometry::StereoHealth& health);

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/capture/grab_stats.h"
#include "engram/capture/stamp_statistics.h"

#include <nlohmann/json.hpp>

#include <iosfwd>

namespace engram::apps {

/// Rate, jitter and the longest gaps, for a person.
void printStamps(std::ostream& out, const capture::StampStatistics::Summary& summary);

/// Keys: seconds, interval_ms {median, p95, max}, jitter_ms, missing, gaps [{from, seconds, missing}].
nlohmann::json stampsJson(const capture::StampStatistics::Summary& summary);

/// One camera of GrabStats.
nlohmann::json cameraJson(const capture::CameraStats& camera);

}  // namespace engram::apps

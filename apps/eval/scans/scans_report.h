// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "scans/scans_filter.h"
#include "scans/scans_world.h"

#include <cstdint>
#include <string>
#include <vector>

namespace engram::apps {

struct ScansResult {
  ScansWorldResult world;
  NeesFigures nees;
  std::vector<SizeFigures> sizes;
};

ResultTable tableOf(const std::vector<ScanRun>& runs);
ResultTable tableOf(const std::vector<SizeFigures>& sizes);

/// Keys: reference_scans, points, ate_open_m, ate_closed_m (by the filter), nees_inside_95, nees_mean, ekf_ms
/// and graph_ms {references: ms}, runs, sizes, window.
nlohmann::json toJson(const ScansResult& result);
std::string toText(const ScansResult& result);
std::string toHtml(const ScansResult& result, const std::string& settings, std::uint64_t seed);

}  // namespace engram::apps

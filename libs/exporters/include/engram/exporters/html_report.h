// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/types/frame_report.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace engram::exporters {

/// JPEGs of images, by index and stamp of the image.
using Pictures = std::map<std::pair<std::uint64_t, double>, std::vector<std::uint8_t>>;

/// What a report is made from. Parts that are absent are left out of the page.
struct HtmlReport {
  std::string title = "Engram map";
  const map::MapHeader* header = nullptr;
  const map::TopologicalMap* map = nullptr;
  std::span<const types::FrameReport> records;
  Pictures pictures = {};  ///< of images of which the map keeps no thumbnail
  std::vector<std::pair<std::string, std::string>> figures;  ///< further rows of the first table: name, value
};

/// One page with all drawings inside; it loads nothing from anywhere. Write it with base::writeText().
std::string toHtml(const HtmlReport& report);

}  // namespace engram::exporters

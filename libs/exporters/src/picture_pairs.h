// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/charts/page.h"
#include "engram/map/topological_map.h"
#include "engram/types/frame_report.h"

#include <span>

namespace engram::exporters {

/// For closures, and for images recognised where there are no closures: the image beside the picture that the
/// place had before, as far as the map keeps thumbnails; of many, some all along the drive. Adds nothing
/// where there is none.
void addPicturePairs(charts::Page& page, const map::TopologicalMap& map,
                     std::span<const types::FrameReport> records);

}  // namespace engram::exporters

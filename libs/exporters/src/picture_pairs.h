// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/charts/page.h"
#include "engram/exporters/html_report.h"

namespace engram::exporters {

/// For closures, and for images recognised where there are no closures: the image beside the first picture
/// that the map keeps of the place; of many, some all along the drive. Adds nothing where the report has no
/// such pictures.
void addPicturePairs(charts::Page& page, const HtmlReport& report);

}  // namespace engram::exporters

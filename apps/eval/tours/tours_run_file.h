// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tours/tours_lab.h"

#include <string>

namespace engram::apps {

/// The raw figures of one method on the tours, so that an experiment need not be run again to draw them.
void writeToursRun(const std::string& path, const ToursRun& run);
/// Throws base::Error with the file when it is damaged.
ToursRun readToursRun(const std::string& path);

}  // namespace engram::apps

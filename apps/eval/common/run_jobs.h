// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <iosfwd>
#include <vector>

namespace engram::apps {

/// Runs all of them on `threads` threads, the first ones first, and says to `progress` (may be null) how many
/// experiments are done. Rethrows the first exception.
void runJobs(const std::vector<std::function<void()>>& jobs, int threads, std::ostream* progress);

}  // namespace engram::apps

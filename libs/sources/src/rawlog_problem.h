// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/rawlog_source.h"

#include <string>

namespace engram::sources {

/// The message of RawlogSource::problem(): damage and everything left out, in sentences; empty when nothing
/// was.
std::string describeProblem(const std::string& path, const std::string& damage, const RawlogStats& stats,
                            const RawlogParams& params, const std::string& usedLabel);

}  // namespace engram::sources

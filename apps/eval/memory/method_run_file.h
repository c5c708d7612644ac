// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "memory/memory_lab.h"

#include <string>

namespace engram::apps {

/// The raw figures of one method, so that an interrupted experiment goes on where it stopped and figures can
/// be drawn again without running it.
void writeMethodRun(const std::string& path, const MethodRun& run);
/// Throws base::Error with the file when it is damaged.
MethodRun readMethodRun(const std::string& path);

}  // namespace engram::apps

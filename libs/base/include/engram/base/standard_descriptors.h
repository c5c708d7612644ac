// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace engram::base {

/// Puts /dev/null where a program was started without standard input, output or error (`2>&-`): the first
/// file it opens would get that number, and messages would be written into it. A standard output that was
/// closed stays one that cannot be written. To be called before anything opens a file.
void openStandardDescriptors();

}  // namespace engram::base

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace engram::base {

/// Makes Ctrl-C and SIGTERM set a flag instead of ending the process, so that a program can finish the image
/// at hand, commit and report. A second signal ends it at once.
void installInterruptHandler();

/// True once a signal came.
bool interrupted();

}  // namespace engram::base

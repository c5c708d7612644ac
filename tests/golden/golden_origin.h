// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace engram::testing {

/// What the last bits of a result depend on beside the source: processor, compiler, kind of build and
/// libraries. Where two of these are equal, so are all results.
std::string goldenOrigin();

}  // namespace engram::testing

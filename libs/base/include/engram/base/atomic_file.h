// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/output_file.h"

#include <functional>
#include <string>
#include <string_view>

namespace engram::base {

/// Calls write(name of a temporary file) and then gives that file the name `path`, as OutputFile does; a
/// device, a pipe or standard output ("-") gets its content. Nothing is left behind when `write` throws, and
/// an earlier file stays. Throws base::Error when `path` exists and `overwrite` is false, or when it cannot
/// be written.
void writeAtomically(const std::string& path, bool overwrite,
                     const std::function<void(const std::string&)>& write);

/// The same for any text or bytes.
void writeText(const std::string& path, std::string_view text, bool overwrite = false,
               Sync sync = Sync::kNow);

}  // namespace engram::base

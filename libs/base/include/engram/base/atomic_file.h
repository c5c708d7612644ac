// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace engram::base {

/// Calls write(name of a temporary file beside `path`) and renames that file to `path`. Nothing is left
/// behind when `write` throws. Throws base::Error when `path` exists and `overwrite` is false, or when it
/// cannot be written.
void writeAtomically(const std::string& path, bool overwrite,
                     const std::function<void(const std::string&)>& write);

/// The same for any text or bytes.
void writeText(const std::string& path, const std::string& text, bool overwrite = false);

}  // namespace engram::base

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace engram::base {

/// Text as every program writes it, with each line ended by '\n': without the byte-order mark of UTF-8, with
/// the line ends of Windows (CR LF) and of old Macs (CR) replaced, and with an end of the last line. Throws
/// base::Error, beginning with `name`, for UTF-16 and for what is no text.
std::string plainText(std::string text, const std::string& name);

/// The whole file as plainText(). All readers of text files go through here.
/// Throws base::Error that begins with the path for a folder and for a file that cannot be opened or read to
/// its end, or is too large for a text.
std::string readTextFile(const std::string& path);

}  // namespace engram::base

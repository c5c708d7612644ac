// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace engram::evaluation {

/// A line that says something: neither empty nor a `#` comment.
struct TextLine {
  std::string text;    ///< without white space at its ends
  std::string origin;  ///< "file.csv:12"
};

/// Of a text that came from anywhere: see base::plainText().
std::vector<TextLine> contentLines(const std::string& text, const std::string& name);

/// Fields between separators; for ' ' any run of white space separates. Trimmed.
std::vector<std::string> splitFields(const std::string& text, char separator);

/// The whole field as a number; throws base::Error with the origin and `what`.
std::int64_t parseInteger(const std::string& field, const std::string& origin, const std::string& what);
double parseReal(const std::string& field, const std::string& origin, const std::string& what);

/// Throws base::Error "origin: what".
[[noreturn]] void refuse(const std::string& origin, const std::string& what);

}  // namespace engram::evaluation

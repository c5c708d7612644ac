// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace engram::charts {

/// Text for HTML and SVG: markup characters are escaped, bytes that are not UTF-8 or not printable are
/// replaced.
std::string escaped(const std::string& text);

/// A number with at most `digits` significant digits and no exponent for common sizes.
std::string number(double value, int digits = 4);

/// About how wide a text is drawn [px]; fonts differ, so that it errs to the wide side.
double textWidth(const std::string& text, double fontSize);

/// The text broken between words into lines of at most `width` pixels, as far as words allow.
std::vector<std::string> wrapped(const std::string& text, double width, double fontSize);

}  // namespace engram::charts

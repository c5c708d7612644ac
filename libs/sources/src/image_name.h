// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace engram::sources {

/// The text of a CObservationComment that names the file of an image; empty when `name` cannot be one.
std::string commentOf(const std::string& name);
/// The file that a comment names; empty when it is any other comment.
std::string nameInComment(const std::string& text);

/// No comment that names a file is longer [byte].
inline constexpr std::size_t kMaxNameComment = 512;

}  // namespace engram::sources

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace engram::base {

/// Throws base::Error when arrays and objects of a JSON text stand more than 64 deep in each other. To be
/// called before a text of a file is parsed: what is made of it is copied and freed by recursion, which ends
/// at the end of the stack. Whether it is JSON at all is the parser's to say.
void requireShallowJson(std::string_view json);

}  // namespace engram::base

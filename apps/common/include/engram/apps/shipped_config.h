// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/config.h"

#include <string>

namespace engram::apps {

/// A configuration of the folder config/ as it was when the program was built, such as `words_mono.ini`.
/// Paths in it are relative to that folder. Throws base::Error when there is none of this name.
base::IniFile shippedConfig(const std::string& name);

}  // namespace engram::apps

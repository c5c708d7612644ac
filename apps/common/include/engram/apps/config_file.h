// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/config.h"

#include <string>
#include <vector>

namespace engram::apps {

/// Where configurations are looked for by name, in this order: `$XDG_CONFIG_HOME/engram`
/// (`~/.config/engram`); the folder `share/engram` beside that of the running program, so that an
/// installation may be moved (in a build tree it is a link to config/); `engram` in `$XDG_DATA_DIRS`
/// (`/usr/local/share`, `/usr/share`).
std::vector<std::string> configFolders();

/// The names of the configurations in these folders, without `.ini`, sorted.
std::vector<std::string> configNames();

/// The file that the user means: a path, or the name of a configuration such as `fsh_omni`.
/// Throws base::ConfigError for a folder, and when there is no such file; the message lists the names.
std::string findConfig(const std::string& given);

/// The configuration that the user means, as IniFile::load().
base::IniFile loadConfig(const std::string& given);

}  // namespace engram::apps

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace engram::apps {

/// What places remember by, and what they are recognised by, must not change in the life of a map: the
/// keys of [memory], [fsh], [multi_store] and [words] and the channel of [appearance] that two configurations
/// have in force with other values, as `[fsh] prune_view = 3 (was 4)`. A key that one of them does not know
/// or does not use is none.
/// @param stored,wanted texts as RunConfig::dumpForMap() makes them
std::vector<std::string> parameterChanges(const std::string& stored, const std::string& wanted);

/// Throws base::ConfigError that names the changes, unless they are accepted.
/// @return the note for the map: empty where nothing has changed
std::string acceptedChanges(const std::vector<std::string>& changes, bool accept, const std::string& map);

}  // namespace engram::apps

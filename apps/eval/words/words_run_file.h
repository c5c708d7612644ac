// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "words/words_localisation.h"
#include "words/words_mapping.h"

#include <string>

namespace engram::apps {

/// The files in `runs/` that an interrupted experiment goes on from. Writing replaces; reading throws
/// base::Error with the name of a file that is not whole.
void writeMappingRun(const std::string& path, const MappingRun& run);
void writeLocalisationRun(const std::string& path, const LocalisationRun& run);
MappingRun readMappingRun(const std::string& path);
LocalisationRun readLocalisationRun(const std::string& path);

}  // namespace engram::apps

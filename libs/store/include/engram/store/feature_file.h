// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"
#include "engram/types/features.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace engram::store {

/// Features of many images in one file: what an experiment extracts once and reads often. Every image is a
/// row with a checksum, as in a map file. The file is written beside `path` and renamed.
void writeFeatureFile(const std::string& path, std::span<const types::Features> images,
                      bool overwrite = false);

/// Throws base::Error with the file and the image for a file of another kind, or a damaged or truncated one.
std::vector<types::Features> readFeatureFile(const std::string& path);

/// The size of what a place remembers in a map file [byte] (F-29).
std::size_t storedBytes(const memory::PlaceMemory& memory);

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "codec.h"
#include "database.h"
#include "engram/map/map_content.h"
#include "engram/store/drive.h"

#include <cstdint>
#include <string>

namespace engram::store {

// Single rows of a map. To be called within a transaction.
void writeHeader(Database& database, const map::MapHeader& header);
void writeState(Database& database, const MapState& state);
void writeDrive(Database& database, const Drive& drive);
void writeRecord(Database& database, std::uint64_t id, const std::string& json);

}  // namespace engram::store

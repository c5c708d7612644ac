// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "codec.h"
#include "connection.h"
#include "engram/map/map_content.h"
#include "engram/store/drive.h"

#include <cstdint>
#include <string>

namespace engram::store {

// Single rows of a map. To be called within a transaction.
void writeHeader(Connection& database, const map::MapHeader& header);
void writeState(Connection& database, const MapState& state);
void writeDrive(Connection& database, const Drive& drive);
void writeRecord(Connection& database, std::uint64_t id, const std::string& json);

}  // namespace engram::store

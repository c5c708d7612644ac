// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "database.h"
#include "engram/store/drive.h"

#include <cstdint>
#include <vector>

namespace engram::store {

inline constexpr std::int64_t kApplicationId = 0x456E676D;  // "Engm"; bytes 68 to 71 of the file

// The tables of a map, in the order in which they are made; docs/map-format.md says what they hold.
inline constexpr const char* kTables[] = {
    "CREATE TABLE header   (key TEXT NOT NULL, value TEXT NOT NULL, crc INTEGER NOT NULL)",
    "CREATE TABLE state    (id INTEGER PRIMARY KEY, data BLOB NOT NULL)",
    "CREATE TABLE places   (id INTEGER PRIMARY KEY, data BLOB NOT NULL)",
    "CREATE TABLE memories (id INTEGER PRIMARY KEY, data BLOB NOT NULL)",
    "CREATE TABLE views    (id INTEGER PRIMARY KEY, data BLOB NOT NULL)",
    "CREATE TABLE edges    (id INTEGER PRIMARY KEY, data BLOB NOT NULL)",
    "CREATE TABLE path     (id INTEGER PRIMARY KEY, data BLOB NOT NULL)",
    "CREATE TABLE records  (id INTEGER PRIMARY KEY, json TEXT NOT NULL, crc INTEGER NOT NULL)",
};
/// What version 2 of the format added.
inline constexpr const char* kTablesOfVersion2[] = {
    "CREATE TABLE drives   (id INTEGER PRIMARY KEY, data BLOB NOT NULL)",
    "CREATE TABLE undo     (kind INTEGER NOT NULL, id INTEGER NOT NULL, data BLOB NOT NULL, "
    "PRIMARY KEY (kind, id)) WITHOUT ROWID",
};

/// What version 3 added.
inline constexpr const char* kTablesOfVersion3[] = {
    "CREATE TABLE derived  (kind INTEGER NOT NULL, id INTEGER NOT NULL, data BLOB NOT NULL, "
    "PRIMARY KEY (kind, id)) WITHOUT ROWID",
};

/// Makes the tables in a new file. To be called within a transaction.
void createSchema(Database& database);

/// Throws base::Error unless the file is a map that this program can read. Returns its format version.
int requireMap(Database& database);

/// The drives of a map of version 1, which did not name them: image numbers begin anew with each. A drive
/// that only taught places left no point on the path.
std::vector<Drive> drivesFromRecords(Connection& database);

/// Brings a map of an older version to the newest. To be called within a transaction.
void upgradeSchema(Database& database, int version);

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "connection.h"
#include "engram/store/whole_map.h"

namespace engram::store {

/// All rows of a map but the totals. What is equal already is not written. To be called within a transaction.
void writeWhole(Connection& database, const WholeMap& whole);

std::map<std::string, std::string> readNotes(Connection& database);

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "database.h"

struct sqlite3;

namespace engram::store {

/// Takes from a connection what a file could make it do by itself: triggers, views, functions with side
/// effects in the schema, other files. To be called before the first statement.
void disarm(sqlite3* connection);

/// Throws base::Error unless the file holds the tables that `statements` create, in the same words, and
/// nothing else: no trigger, view, index, virtual table or generated column, and no table whose pages are
/// another's.
void requireSchema(Database& database, const char* statements);

}  // namespace engram::store

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blob.h"
#include "connection.h"
#include "engram/map/derived.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace engram::store {

// Rows of the table `derived`. Each holds the checksum of the row that it was made of, its basis: what has
// changed without it is found by that, whoever changed it.

inline constexpr const char* kPutDerived =
    "INSERT INTO derived VALUES ($1, $2, $3) ON CONFLICT (kind, id) DO UPDATE SET data = excluded.data";

/// Of the table that rows of this kind are made of; empty for words, which need none.
Checksums basesOf(Connection& database, map::DerivedKind kind);

/// Hands over the rows of a kind that hold good.
void readDerived(Connection& database, map::DerivedKind kind, const Checksums& bases,
                 const map::Derived::Take& take);

/// Everything that is wrong with the table, one sentence each. What is outdated is not wrong.
void checkDerived(Connection& database, std::vector<std::string>& problems);

/// Writes rows, and drops those whose basis is gone. To be called within a transaction.
void writeDerived(Connection& database, std::span<const map::DerivedRow> rows);

}  // namespace engram::store

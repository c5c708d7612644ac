// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "connection.h"
#include "engram/base/error.h"

#include <memory>
#include <string>

namespace engram::store {

/// Whether a map is named by an address of a server, not by a file.
bool isOnServer(const std::string& map);

/// The parts of `postgresql://host:port/db?map=name&…`.
struct ServerAddress {
  std::string uri;     ///< for libpq, without `map`
  std::string schema;  ///< that holds the map
};
/// Throws base::Error for an address without a map, with a name that is none, or with a password.
ServerAddress parseAddress(const std::string& map);

enum class ServerMode { kCreate, kReplace, kReadWrite, kReadOnly };

/// A connection to a map on a PostgreSQL server. The map is a schema with the tables of a map file, the same
/// rows in them. kCreate and kReplace make it by makeTables(), within their transaction; they and kReadWrite
/// take the lock of the one who writes, an advisory lock that dies with the connection.
/// Throws base::Error, with what to do, when the server cannot be reached, the role may not, the map is not
/// there (or is), or another program writes it.
std::unique_ptr<Connection> connectToServer(const std::string& map, ServerMode mode);

/// The server cannot be reached, or not any more: what was being committed is not there, or was as the
/// connection broke.
class ServerAway : public base::Error {
 public:
  using Error::Error;
};

/// Whether there is such a map.
bool existsOnServer(const std::string& map);

}  // namespace engram::store

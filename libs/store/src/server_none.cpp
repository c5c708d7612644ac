// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "server.h"

namespace engram::store {
namespace {

[[noreturn]] void builtWithout(const std::string& map) {
  throw base::Error("'" + map + "': this program was built without libpqxx and reads map files alone");
}

}  // namespace

std::unique_ptr<Connection> connectToServer(const std::string& map, ServerMode) { builtWithout(map); }
bool existsOnServer(const std::string& map) { builtWithout(map); }

}  // namespace engram::store

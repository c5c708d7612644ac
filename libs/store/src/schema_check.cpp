// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "schema_check.h"

#include "engram/base/error.h"
#include "engram/base/text.h"

#include <sqlite3.h>

#include <cctype>
#include <map>
#include <set>
#include <utility>

namespace engram::store {
namespace {

struct Entry {
  std::string sql;  ///< of the statement that made it, blanks as one
  std::int64_t page = 0;
};

/// By type and name.
using Schema = std::map<std::pair<std::string, std::string>, Entry>;

std::string withoutRunsOfBlanks(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (blank && (out.empty() || out.back() == ' ')) continue;
    out += blank ? ' ' : c;
  }
  return out;
}

Schema schemaOf(Database& database) {
  Schema schema;
  Statement entry(database, "SELECT type, name, sql, rootpage FROM sqlite_master");
  while (entry.step())
    schema[{entry.text(0), entry.text(1)}] = {withoutRunsOfBlanks(entry.text(2)), entry.integer(3)};
  return schema;
}

std::string nameOf(const Schema::value_type& item) {
  return base::printable(item.first.first) + " " + base::quoted(item.first.second);
}

[[noreturn]] void refuse(const Database& database, const std::string& what) {
  throw base::Error("map '" + database.path() + "' is damaged, or was not made by Engram: " + what);
}

}  // namespace

void disarm(sqlite3* connection) {
  const auto set = [connection](int what, int value) { sqlite3_db_config(connection, what, value, nullptr); };
  set(SQLITE_DBCONFIG_ENABLE_TRIGGER, 0);
  set(SQLITE_DBCONFIG_ENABLE_VIEW, 0);
  set(SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0);
  set(SQLITE_DBCONFIG_DEFENSIVE, 1);
  set(SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0);
  set(SQLITE_DBCONFIG_ENABLE_FTS3_TOKENIZER, 0);
  sqlite3_limit(connection, SQLITE_LIMIT_ATTACHED, 0);
}

void requireSchema(Database& database, const char* statements) {
  Database model(database.path());
  model.execute(statements);
  const Schema expected = schemaOf(model), found = schemaOf(database);
  std::set<std::int64_t> pages;
  for (const auto& item : found) {
    const auto& [key, entry] = item;
    const auto known = expected.find(key);
    if (known == expected.end()) refuse(database, "it holds the " + nameOf(item) + ", which no map has");
    if (known->second.sql != entry.sql) refuse(database, nameOf(item) + " has other columns than in a map");
    if (entry.page < 2 || !pages.insert(entry.page).second)
      refuse(database, nameOf(item) + " has no pages of its own");
  }
  for (const auto& item : expected)
    if (!found.contains(item.first)) refuse(database, nameOf(item) + " is missing");
}

}  // namespace engram::store

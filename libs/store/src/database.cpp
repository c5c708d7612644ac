// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "database.h"

#include "diagnosis.h"
#include "engram/base/error.h"
#include "schema_check.h"

#include <sqlite3.h>

#include <cctype>
#include <cstring>
#include <filesystem>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

/// Other programs may hold the file for the time of one commit.
constexpr int kBusyTimeoutMs = 5000;
/// The end of a run does not wait for those who read for long.
constexpr int kCloseTimeoutMs = 500;
/// A program that reads a large map takes as long; writing begins after it.
constexpr int kReadersTimeoutMs = 60000;
/// No row is larger; bounds what a damaged length can make us allocate.
constexpr int kMaxRowBytes = 256 << 20;

std::string percentEncoded(const std::string& path) {
  static const char* const kHex = "0123456789ABCDEF";
  std::string out;
  for (const char c : path) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) || std::strchr("/._-", c) != nullptr)
      out += c;
    else
      (out += '%').append({kHex[u >> 4], kHex[u & 15]});
  }
  return out;
}

}  // namespace

Statement::Statement(Database& database, const char* sql) : database_(database) {
  const int code = sqlite3_prepare_v2(database.handle(), sql, -1, &statement_, nullptr);
  if (code != SQLITE_OK) database.fail(code);
}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::bind(int position, std::uint64_t value) {
  const int code = sqlite3_bind_int64(statement_, position, static_cast<sqlite3_int64>(value));
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

Statement& Statement::bind(int position, const Blob& value) {
  const int code = sqlite3_bind_blob64(statement_, position, value.data(), value.size(), SQLITE_STATIC);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

Statement& Statement::bind(int position, const std::string& value) {
  const int code =
      sqlite3_bind_text64(statement_, position, value.data(), value.size(), SQLITE_STATIC, SQLITE_UTF8);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_.fail(code);
  return false;
}

void Statement::run() {
  while (step()) {
  }
  sqlite3_reset(statement_);
}

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_, column); }

std::span<const std::uint8_t> Statement::blob(int column) const {
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
  const int size = sqlite3_column_bytes(statement_, column);
  return {data, data == nullptr ? 0u : static_cast<std::size_t>(size)};
}

std::string Statement::text(int column) const {
  const auto bytes = blob(column);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Database::Database(const std::string& path, Mode mode) : path_(path) {
  // An absolute path: ':memory:' and 'file:x' are then plain file names.
  const std::string file = fs::absolute(path).string();
  if (mode == Mode::kReadOnly)
    connectToRead(file);
  else if (mode == Mode::kDamaged)
    connectDamaged(file);
  else
    connect(file, SQLITE_OPEN_READWRITE | (mode == Mode::kCreate ? SQLITE_OPEN_CREATE : 0));
  // Pages that a drive has freed are given back to the disk at its end.
  if (mode == Mode::kCreate) execute("PRAGMA auto_vacuum = INCREMENTAL");
}

void Database::connectToRead(const std::string& file) {
  const auto connectToUnchanging = [&] {
    connect("file:" + percentEncoded(file) + "?immutable=1", SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
  };
  // Without its log nothing must appear beside it: an empty log would hide that one is missing.
  if (logIsMissing(file)) {
    connectToUnchanging();
    return;
  }
  try {
    connect(file, SQLITE_OPEN_READONLY);
  } catch (const base::Error&) {
    if (fs::exists(file + "-journal")) {
      // A commit was cut off: undo it first, which a reader may not.
      connect(file, SQLITE_OPEN_READWRITE);
      handle_.reset();
      connect(file, SQLITE_OPEN_READONLY);
    } else if (!fs::exists(file + "-wal")) {
      // The medium is read-only: nobody can change it.
      connectToUnchanging();
    } else {
      throw;
    }
  }
}

void Database::beginSnapshot() {
  execute("BEGIN");
  number("SELECT count(*) FROM sqlite_master");  // a transaction begins with what is read first
}

void Database::beginWriting() {
  // The log makes a commit cheap and safe when the process is killed; FULL makes it safe when the power
  // fails.
  sqlite3_busy_timeout(handle_.get(), kReadersTimeoutMs);
  const int code = sqlite3_exec(handle_.get(), "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;",
                                nullptr, nullptr, nullptr);
  sqlite3_busy_timeout(handle_.get(), kBusyTimeoutMs);
  if ((code & 0xff) == SQLITE_BUSY)
    throw base::Error("map '" + path_ + "': another program has been reading it for " +
                      std::to_string(kReadersTimeoutMs / 1000) + " s. Wait until it has ended");
  if (code != SQLITE_OK) fail(code);
}

Database::Database(std::string name) : path_(std::move(name)) {
  connect(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY);
}

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close(handle); }

void Database::connect(const std::string& file, int flags) {
  sqlite3* opened = nullptr;
  int code = sqlite3_open_v2(file.c_str(), &opened, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  handle_.reset(opened);
  if (code == SQLITE_OK) {
    sqlite3_extended_result_codes(opened, 1);
    sqlite3_busy_timeout(opened, kBusyTimeoutMs);
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, kMaxRowBytes);
    disarm(opened);
    code = sqlite3_exec(
        opened, "PRAGMA cell_size_check = ON; PRAGMA application_id; SELECT count(*) FROM sqlite_master;",
        nullptr, nullptr, nullptr);
  }
  if (code == SQLITE_OK) return;
  const std::string why = explanation(code, sqlite3_system_errno(opened), path_);
  handle_.reset();
  throw base::Error("map '" + path_ + "': " + why);
}

void Database::connectDamaged(const std::string& file) {
  sqlite3* opened = nullptr;
  const int code =
      sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr);
  handle_.reset(opened);
  if (code != SQLITE_OK) fail(code);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, kMaxRowBytes);
  for (const int option : {SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW})
    sqlite3_db_config(opened, option, 0, nullptr);
  // The second makes SQLite open a file that is cut short.
  execute("PRAGMA trusted_schema = OFF; PRAGMA writable_schema = ON; PRAGMA cell_size_check = ON");
}

void Database::execute(const char* sql) {
  const int code = sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

void Database::foldLog() {
  sqlite3_busy_timeout(handle_.get(), kCloseTimeoutMs);
  execute("PRAGMA wal_checkpoint(TRUNCATE)");
  const int code = sqlite3_exec(handle_.get(), "PRAGMA journal_mode = DELETE", nullptr, nullptr, nullptr);
  if (code != SQLITE_OK && (code & 0xff) != SQLITE_BUSY) fail(code);
}

std::int64_t Database::number(const char* sql) {
  Statement statement(*this, sql);
  if (!statement.step()) throw base::Error("map '" + path_ + "': it is damaged");
  return statement.integer(0);
}

void Database::fail(int code) const {
  const int extended = sqlite3_extended_errcode(handle_.get());
  const bool same = (extended & 0xff) == (code & 0xff);
  throw base::Error(
      "map '" + path_ +
      "': " + explanation(same ? extended : code, same ? sqlite3_system_errno(handle_.get()) : 0, path_));
}

Transaction::Transaction(Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }

Transaction::~Transaction() {
  // SQLite may have rolled back by itself, after which this fails without harm.
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace engram::store

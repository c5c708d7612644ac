// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "database.h"

#include "diagnosis.h"
#include "engram/base/error.h"
#include "schema.h"
#include "schema_check.h"

#include <sqlite3.h>

#include <cctype>
#include <cstring>
#include <filesystem>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

/// Reads the ends of rows, which are their checksums. The pages of a long row before its last are not read.
class RowEnds {
 public:
  RowEnds(sqlite3* database, const char* table) : database_(database), table_(table) {}
  ~RowEnds() { sqlite3_blob_close(blob_); }
  RowEnds(const RowEnds&) = delete;
  RowEnds& operator=(const RowEnds&) = delete;

  /// None when there is no such row.
  std::optional<std::uint32_t> checksum(std::uint32_t id) {
    const int code = blob_ == nullptr ? sqlite3_blob_open(database_, "main", table_, "data",
                                                          static_cast<sqlite3_int64>(id), 0, &blob_)
                                      : sqlite3_blob_reopen(blob_, static_cast<sqlite3_int64>(id));
    std::uint32_t sum = 0;
    const int size = code == SQLITE_OK ? sqlite3_blob_bytes(blob_) : 0;
    const bool read = size >= 4 && sqlite3_blob_read(blob_, &sum, sizeof sum,
                                                     size - static_cast<int>(sizeof sum)) == SQLITE_OK;
    if (!read) close();
    return read ? std::optional(sum) : std::nullopt;
  }

 private:
  void close() {
    sqlite3_blob_close(blob_);
    blob_ = nullptr;
  }

  sqlite3* database_;
  const char* table_;
  sqlite3_blob* blob_ = nullptr;
};

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

class SqliteCursor : public Cursor {
 public:
  SqliteCursor(Database& database, const char* sql) : database_(database) {
    check(sqlite3_prepare_v2(database.handle(), sql, -1, &statement_, nullptr));
  }
  ~SqliteCursor() override { sqlite3_finalize(statement_); }
  SqliteCursor(const SqliteCursor&) = delete;
  SqliteCursor& operator=(const SqliteCursor&) = delete;

  void bind(int position, std::uint64_t value) override {
    check(sqlite3_bind_int64(statement_, position, static_cast<sqlite3_int64>(value)));
  }
  void bind(int position, const Blob& value) override {
    check(sqlite3_bind_blob64(statement_, position, value.data(), value.size(), SQLITE_STATIC));
  }
  void bind(int position, const std::string& value) override {
    check(sqlite3_bind_text64(statement_, position, value.data(), value.size(), SQLITE_STATIC, SQLITE_UTF8));
  }
  bool step() override {
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) database_.fail(code);
    return false;
  }
  void reset() override { sqlite3_reset(statement_); }
  std::int64_t integer(int column) const override { return sqlite3_column_int64(statement_, column); }
  std::span<const std::uint8_t> blob(int column) const override {
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
    const int size = sqlite3_column_bytes(statement_, column);
    return {data, data == nullptr ? 0u : static_cast<std::size_t>(size)};
  }

 private:
  void check(int code) const {
    if (code != SQLITE_OK) database_.fail(code);
  }

  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace

Database::Database(const std::string& path, Mode mode) : path_(path), writable_(mode != Mode::kReadOnly) {
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

std::unique_ptr<Cursor> Database::prepare(const char* sql) {
  return std::make_unique<SqliteCursor>(*this, sql);
}

void Database::rollBack() noexcept {
  // SQLite may have rolled back by itself, after which this fails without harm.
  sqlite3_exec(handle_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Database::makeTables() { createSchema(*this); }
int Database::formatVersion() { return requireMap(*this); }
void Database::upgrade(int version) { upgradeSchema(*this, version); }

void Database::finish(bool wrote) {
  const bool logged = fs::exists(path_ + "-wal");  // another writer has left it
  if (writable_ && (wrote || logged)) foldLog();
  handle_.reset();
}

Checksums Database::checksums(const char* table) {
  Checksums sums;
  RowEnds ends(handle_.get(), table);
  Statement ids(*this, ("SELECT id FROM " + std::string(table) + " ORDER BY id").c_str());
  while (ids.step()) {
    const auto id = static_cast<std::uint32_t>(ids.integer(0));
    if (const auto sum = ends.checksum(id)) sums.emplace_hint(sums.end(), id, *sum);
  }
  return sums;
}

std::vector<std::string> Database::integrity() {
  std::vector<std::string> problems;
  Statement check(*this, "PRAGMA integrity_check");
  while (check.step())
    if (check.text(0) != "ok") problems.push_back(check.text(0));
  return problems;
}

std::uint64_t Database::bytes() {
  std::uint64_t sum = 0;
  for (const char* suffix : {"", "-wal"}) {
    std::error_code error;
    const auto size = fs::file_size(path_ + suffix, error);
    if (!error) sum += size;
  }
  return sum;
}

void Database::fail(int code) const {
  const int extended = sqlite3_extended_errcode(handle_.get());
  const bool same = (extended & 0xff) == (code & 0xff);
  throw base::Error(
      "map '" + path_ +
      "': " + explanation(same ? extended : code, same ? sqlite3_system_errno(handle_.get()) : 0, path_));
}

}  // namespace engram::store

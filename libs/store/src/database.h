// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "connection.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace engram::store {

/// A connection to one SQLite file. Errors become base::Error with the path and what to do.
class Database : public Connection {
 public:
  /// kDamaged opens what SQLite opens at all, without looking into it: for a copy of one's own.
  enum class Mode { kCreate, kReadWrite, kReadOnly, kDamaged };
  Database(const std::string& path, Mode mode);
  /// An empty one in memory. `name` is for messages.
  explicit Database(std::string name);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const char* sql) override;
  std::unique_ptr<Cursor> prepare(const char* sql) override;
  void begin() override { execute("BEGIN IMMEDIATE"); }
  void commit() override { execute("COMMIT"); }
  void rollBack() noexcept override;
  Checksums checksums(const char* table) override;
  void makeTables() override;
  int formatVersion() override;
  void upgrade(int version) override;
  /// What is read from now on is of one moment, whatever a writer does.
  void beginSnapshot() override;
  /// Makes ready for commits. Waits while others read; no byte changes before this call.
  void beginWriting() override;
  /// Makes it one file again before it is closed. Leaving the log mode needs the file for oneself: while
  /// others read it the log stays beside it, empty, and the next writer leaves the mode.
  void foldLog();
  void giveBackSpace() override { execute("PRAGMA incremental_vacuum"); }
  void finish(bool wrote) override;
  std::vector<std::string> integrity() override;
  std::uint64_t bytes() override;
  const std::string& path() const override { return path_; }
  sqlite3* handle() const { return handle_.get(); }

  /// Throws what the last SQLite call failed with.
  [[noreturn]] void fail(int code) const;

 private:
  void connect(const std::string& file, int flags);
  void connectToRead(const std::string& file);
  void connectDamaged(const std::string& file);

  struct Close {
    void operator()(sqlite3* handle) const;
  };

  std::string path_;
  bool writable_ = false;
  std::unique_ptr<sqlite3, Close> handle_;  // closed too when a constructor throws
};

}  // namespace engram::store

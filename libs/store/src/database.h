// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blob.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace engram::store {

class Database;

/// A prepared statement. Positions count from 1 for bind(), from 0 for columns, as in SQLite.
class Statement {
 public:
  Statement(Database& database, const char* sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int position, std::uint64_t value);
  Statement& bind(int position, const Blob& value);         ///< kept until step()
  Statement& bind(int position, const std::string& value);  ///< kept until step()
  /// True while there is a row.
  bool step();
  /// Executes once and makes ready for the next bind().
  void run();

  std::int64_t integer(int column) const;
  std::span<const std::uint8_t> blob(int column) const;  ///< valid until the next step()
  std::string text(int column) const;

 private:
  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

/// A connection to one SQLite file. Errors become base::Error with the path and what to do.
class Database {
 public:
  /// kDamaged opens what SQLite opens at all, without looking into it: for a copy of one's own.
  enum class Mode { kCreate, kReadWrite, kReadOnly, kDamaged };
  Database(const std::string& path, Mode mode);
  /// An empty one in memory. `name` is for messages.
  explicit Database(std::string name);
  ~Database() = default;
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const char* sql);
  std::int64_t number(const char* sql);
  /// What is read from now on is of one moment, whatever a writer does.
  void beginSnapshot();
  /// Makes ready for commits. Waits while others read; no byte changes before this call.
  void beginWriting();
  /// Makes it one file again before it is closed. Leaving the log mode needs the file for oneself: while
  /// others read it the log stays beside it, empty, and the next writer leaves the mode.
  void foldLog();
  const std::string& path() const { return path_; }
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
  std::unique_ptr<sqlite3, Close> handle_;  // closed too when a constructor throws
};

/// Begins a writing transaction and rolls it back unless commit() was called.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace engram::store

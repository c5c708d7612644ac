// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blob.h"

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace engram::store {

/// One statement as one kind of database runs it. Positions count from 1, columns from 0.
class Cursor {
 public:
  virtual ~Cursor() = default;
  virtual void bind(int position, std::uint64_t value) = 0;
  virtual void bind(int position, const Blob& value) = 0;         ///< kept until step()
  virtual void bind(int position, const std::string& value) = 0;  ///< kept until step()
  virtual bool step() = 0;
  virtual void reset() = 0;
  virtual std::int64_t integer(int column) const = 0;
  virtual std::span<const std::uint8_t> blob(int column) const = 0;
};

/// The checksums of the rows of a table, by number; read without the rows themselves.
using Checksums = std::map<std::uint32_t, std::uint32_t>;

/// Where the rows of one map are: a file of SQLite, or a schema of a server. What reads and writes rows knows
/// no more than this. SQL is that which both understand: parameters `$1`, `$2` in the order in which they
/// first appear, `ON CONFLICT`.
class Connection {
 public:
  virtual ~Connection() = default;

  virtual const std::string& path() const = 0;  ///< of the map, for messages
  virtual void execute(const char* sql) = 0;
  virtual std::unique_ptr<Cursor> prepare(const char* sql) = 0;
  std::int64_t number(const char* sql);

  // A transaction that writes.
  virtual void begin() = 0;
  virtual void commit() = 0;
  virtual void rollBack() noexcept = 0;

  /// Of the rows of a table whose `data` end with them.
  virtual Checksums checksums(const char* table) = 0;

  /// Makes the tables of an empty map. To be called within a transaction.
  virtual void makeTables() = 0;
  /// Throws base::Error unless it holds a map that this program can read. Returns its format version.
  virtual int formatVersion() = 0;
  /// Brings a map of an older version to the newest. To be called within a transaction.
  virtual void upgrade(int version) = 0;
  /// What is read from now on is of one moment, whatever a writer does.
  virtual void beginSnapshot() = 0;
  /// Makes ready for commits. No byte changes before this call.
  virtual void beginWriting() = 0;
  /// Gives the space of rows that have gone back, where that is not done by itself.
  virtual void giveBackSpace() = 0;
  /// To be called last. @param wrote beginWriting() was called
  virtual void finish(bool wrote) = 0;

  /// What is wrong below the rows.
  virtual std::vector<std::string> integrity() = 0;
  virtual std::uint64_t bytes() = 0;
};

/// A prepared statement. Positions count from 1 for bind(), from 0 for columns.
class Statement {
 public:
  Statement(Connection& connection, const char* sql) : cursor_(connection.prepare(sql)) {}

  Statement& bind(int position, std::uint64_t value);
  Statement& bind(int position, const Blob& value);         ///< kept until step()
  Statement& bind(int position, const std::string& value);  ///< kept until step()
  /// True while there is a row.
  bool step() { return cursor_->step(); }
  /// Executes once and makes ready for the next bind().
  void run();

  std::int64_t integer(int column) const { return cursor_->integer(column); }
  std::span<const std::uint8_t> blob(int column) const { return cursor_->blob(column); }  ///< until step()
  std::string text(int column) const;

 private:
  std::unique_ptr<Cursor> cursor_;
};

/// Begins a writing transaction and rolls it back unless commit() was called.
class Transaction {
 public:
  explicit Transaction(Connection& connection) : connection_(connection) { connection_.begin(); }
  ~Transaction() {
    if (open_) connection_.rollBack();
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit() {
    connection_.commit();
    open_ = false;
  }

 private:
  Connection& connection_;
  bool open_ = true;
};

}  // namespace engram::store

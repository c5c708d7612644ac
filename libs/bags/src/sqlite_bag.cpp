// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_codec.h"
#include "bag_formats.h"

#include <sqlite3.h>

#include <map>

namespace engram::bags {
namespace {

/// A `.db3` of rosbag2, opened for reading alone.
class SqliteBag final : public BagReader {
 public:
  explicit SqliteBag(const std::string& path) : BagReader(path) {
    sqlite3* raw = nullptr;
    const int status = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(raw);
    if (status != SQLITE_OK) fail();
    sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxBagRecord));
    sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    readTopics();
    rows_ = prepare("SELECT topic_id, timestamp, data, id FROM messages ORDER BY timestamp, id");
    total_ = count();
  }
  double progress() const override {
    return total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 1.0;
  }

 protected:
  std::optional<BagMessage> read() override {
    if (!step(rows_)) return std::nullopt;
    ++done_;
    const auto found = ids_.find(sqlite3_column_int64(rows_.get(), 0));
    if (found == ids_.end()) throw base::Error("a message of a topic that is not described");
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(rows_.get(), 2));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(rows_.get(), 2));
    BagMessage message{found->second, sqlite3_column_int64(rows_.get(), 1), {}};
    if (data != nullptr) message.data = decompressMessage({data, data + size});
    return message;
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Close>;

  [[noreturn]] void fail() const {
    throw base::Error(path_ + ": cannot be read as a ROS 2 bag (" + sqlite3_errmsg(database_.get()) + ")");
  }
  Statement prepare(const char* query) {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &raw, nullptr) != SQLITE_OK) fail();
    return Statement(raw);
  }
  bool step(const Statement& statement) const {
    const int status = sqlite3_step(statement.get());
    if (status != SQLITE_ROW && status != SQLITE_DONE) fail();
    return status == SQLITE_ROW;
  }
  static std::string textOf(const Statement& statement, int column) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement.get(), column));
    return text != nullptr ? text : "";
  }
  void readTopics() {
    const Statement rows = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (step(rows)) {
      const std::string format = textOf(rows, 3), type = plainType(textOf(rows, 2));
      ids_[sqlite3_column_int64(rows.get(), 0)] = topics_.size();
      topics_.push_back({textOf(rows, 1), format == "cdr" ? type : format + ":" + type, true, 0});
    }
  }
  std::int64_t count() {
    const Statement rows = prepare("SELECT count(*) FROM messages");
    return step(rows) ? sqlite3_column_int64(rows.get(), 0) : 0;
  }

  std::unique_ptr<sqlite3, Close> database_;
  Statement rows_;
  std::map<std::int64_t, std::size_t> ids_;
  std::int64_t total_ = 0, done_ = 0;
};

}  // namespace

std::unique_ptr<BagReader> openSqliteBag(const std::string& path) {
  return std::make_unique<SqliteBag>(path);
}

}  // namespace engram::bags

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "server.h"

#include "engram/base/error.h"
#include "engram/store/map_file.h"

#include <map>
#include <optional>
#include <pqxx/pqxx>
#include <unistd.h>

namespace engram::store {
namespace {

// The tables of schema.h; numbers are 64 bits wide here.
constexpr const char* kServerTables[] = {
    "CREATE TABLE format   (version BIGINT NOT NULL)",
    "CREATE TABLE header   (key TEXT NOT NULL, value TEXT NOT NULL, crc BIGINT NOT NULL)",
    "CREATE TABLE state    (id BIGINT PRIMARY KEY, data BYTEA NOT NULL)",
    "CREATE TABLE places   (id BIGINT PRIMARY KEY, data BYTEA NOT NULL)",
    "CREATE TABLE memories (id BIGINT PRIMARY KEY, data BYTEA NOT NULL)",
    "CREATE TABLE views    (id BIGINT PRIMARY KEY, data BYTEA NOT NULL)",
    "CREATE TABLE edges    (id BIGINT PRIMARY KEY, data BYTEA NOT NULL)",
    "CREATE TABLE path     (id BIGINT PRIMARY KEY, data BYTEA NOT NULL)",
    "CREATE TABLE records  (id BIGINT PRIMARY KEY, json TEXT NOT NULL, crc BIGINT NOT NULL)",
    "CREATE TABLE drives   (id BIGINT PRIMARY KEY, data BYTEA NOT NULL)",
    "CREATE TABLE undo     (kind BIGINT NOT NULL, id BIGINT NOT NULL, data BYTEA NOT NULL, PRIMARY KEY "
    "(kind, id))",
    "CREATE TABLE derived  (kind BIGINT NOT NULL, id BIGINT NOT NULL, data BYTEA NOT NULL, PRIMARY KEY "
    "(kind, id))",
};
constexpr int kLockTries = 20;
constexpr unsigned kLockPause = 50000;  // [us]
constexpr const char* kPlainTables[] = {"places", "memories", "views", "edges", "path"};

/// What an error of the server means to a user.
std::string explained(const pqxx::sql_error& e) {
  std::string what = e.what();
  while (!what.empty() && what.back() == '\n') what.pop_back();
  if (dynamic_cast<const pqxx::insufficient_privilege*>(&e) != nullptr)
    return what +
           ". Your role may not do this: engram_reader reads, engram_robot writes maps, engram_keeper makes "
           "them";
  if (dynamic_cast<const pqxx::disk_full*>(&e) != nullptr) return "the disk of the server is full: " + what;
  if (what.find("read-only transaction") != std::string::npos)
    return what + ". This server is a replica: write to its primary";
  return what;
}

/// Calls f() and turns what libpqxx throws into base::Error.
template <class F>
auto guarded(const std::string& map, F&& f) {
  try {
    return f();
  } catch (const pqxx::sql_error& e) {
    if (std::string(e.what()).find("terminating connection") != std::string::npos)
      throw ServerAway("map '" + map + "': " + explained(e));
    throw base::Error("map '" + map + "': " + explained(e));
  } catch (const pqxx::broken_connection& e) {
    std::string what = e.what();
    while (!what.empty() && what.back() == '\n') what.pop_back();
    throw ServerAway("map '" + map + "': the server cannot be reached: " + what +
                     ". What was committed is safe; --resume goes on with a drive that was cut off");
  } catch (const pqxx::failure& e) {
    throw base::Error("map '" + map + "': " + e.what());
  }
}

pqxx::binarystring bigEndian(std::uint64_t value) {
  char bytes[8];
  for (int i = 0; i < 8; ++i) bytes[i] = static_cast<char>(value >> (56 - 8 * i));
  return {bytes, sizeof bytes};
}

class Server;

/// Parameters go as they are, in binary; a result is held until the next one.
class ServerCursor : public Cursor {
 public:
  ServerCursor(Server& server, std::string name) : server_(server), name_(std::move(name)) {}

  void bind(int position, std::uint64_t value) override { set(position, bigEndian(value)); }
  void bind(int position, const Blob& value) override { set(position, {value.data(), value.size()}); }
  void bind(int position, const std::string& value) override { set(position, {value.data(), value.size()}); }
  bool step() override;
  void reset() override {
    result_.reset();
    row_ = -1;
  }
  std::int64_t integer(int column) const override { return at(column).as<std::int64_t>(); }
  std::span<const std::uint8_t> blob(int column) const override;

 private:
  void set(int position, const pqxx::binarystring& value) {
    const auto index = static_cast<std::size_t>(position) - 1;
    while (parameters_.size() <= index) parameters_.emplace_back(std::string());
    parameters_[index] = value;
  }
  pqxx::field at(int column) const { return (*result_)[static_cast<pqxx::result::size_type>(row_)][column]; }

  Server& server_;
  std::string name_;
  std::vector<pqxx::binarystring> parameters_;
  std::optional<pqxx::result> result_;
  long row_ = -1;
  mutable std::map<int, std::string> bytes_;  // of the row
};

class Server : public Connection {
 public:
  Server(const std::string& map, ServerMode mode)
      : map_(map), address_(parseAddress(map)), mode_(mode), connection_(connected()) {
    guarded(map_, [&] {
      work_ = std::make_unique<pqxx::nontransaction>(*connection_);
      work_->exec("SET client_min_messages TO error");
      work_->exec("SET search_path TO \"" + address_.schema + "\"");
      if (mode_ != ServerMode::kReadOnly) lock();
      process_ = connection_->backendpid();
    });
    const bool there = exists();
    if (mode_ == ServerMode::kCreate && there)
      throw base::Error("map '" + map_ + "' exists already. Extend it, overwrite it, or choose another name");
    if (!there && (mode_ == ServerMode::kReadOnly || mode_ == ServerMode::kReadWrite))
      throw base::Error("map '" + map_ + "' does not exist");
  }

  bool exists() {
    return number(("SELECT count(*) FROM pg_tables WHERE schemaname = '" + address_.schema +
                   "' AND tablename = 'format'")
                      .c_str()) > 0;
  }

  const std::string& path() const override { return map_; }
  void execute(const char* sql) override {
    guarded(map_, [&] { work_->exec(sql); });
  }
  std::unique_ptr<Cursor> prepare(const char* sql) override;
  pqxx::result run(const std::string& name, const std::vector<pqxx::binarystring>& parameters) {
    return guarded(
        map_, [&] { return work_->exec_prepared(name, pqxx::prepare::make_dynamic_params(parameters)); });
  }

  /// A connection that libpqxx has brought back by itself has lost the lock.
  void begin() override {
    execute("BEGIN");
    if (connection_->backendpid() == process_) return;
    rollBack();
    throw ServerAway("map '" + map_ +
                     "': the connection to the server was cut. --resume goes on with the drive");
  }
  void commit() override { execute("COMMIT"); }
  void rollBack() noexcept override {
    try {
      work_->exec("ROLLBACK");
    } catch (const std::exception&) {
      // The connection is gone, and the transaction with it.
    }
  }
  Checksums checksums(const char* table) override {
    // The last four bytes, the lowest first.
    const std::string data = "get_byte(data, length(data) - ";
    Statement rows(*this, ("SELECT id, " + data + "4)::BIGINT + (" + data + "3)::BIGINT << 8) + (" + data +
                           "2)::BIGINT << 16) + (" + data + "1)::BIGINT << 24) FROM " + table +
                           " WHERE length(data) >= 4 ORDER BY id")
                              .c_str());
    Checksums sums;
    while (rows.step())
      sums.emplace_hint(sums.end(), static_cast<std::uint32_t>(rows.integer(0)),
                        static_cast<std::uint32_t>(rows.integer(1)));
    return sums;
  }
  void makeTables() override {
    const std::string schema = "\"" + address_.schema + "\"";
    if (mode_ == ServerMode::kReplace && exists()) execute(("DROP SCHEMA " + schema + " CASCADE").c_str());
    execute(("CREATE SCHEMA " + schema).c_str());
    for (const char* table : kServerTables) execute(table);
    execute(("INSERT INTO format VALUES (" + std::to_string(kFormatVersion) + ")").c_str());
    for (const char* table : kPlainTables)  // rows are compressed already
      execute(("ALTER TABLE " + std::string(table) + " ALTER COLUMN data SET STORAGE EXTERNAL").c_str());
    grant(schema);
  }
  int formatVersion() override {
    const auto version = number("SELECT version FROM format");
    if (version == kFormatVersion) return kFormatVersion;
    throw base::Error("map '" + map_ + "' has format " + std::to_string(version) + "; this program reads " +
                      std::to_string(kFormatVersion) + " on a server. Use a newer Engram");
  }
  void upgrade(int) override {}
  void beginSnapshot() override {
    execute("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY");
    number("SELECT count(*) FROM format");
  }
  void beginWriting() override {}
  void giveBackSpace() override {}  // the server does
  void finish(bool) override {
    closedBytes_ = bytes();
    work_.reset();
    connection_.reset();
  }
  std::vector<std::string> integrity() override { return {}; }  // pages are the server's
  std::uint64_t bytes() override {
    if (!work_) return closedBytes_;
    return static_cast<std::uint64_t>(number(
        ("SELECT coalesce(sum(pg_total_relation_size(c.oid)), 0)::BIGINT FROM pg_class c JOIN pg_namespace n "
         "ON c.relnamespace = n.oid WHERE c.relkind = 'r' AND n.nspname = '" +
         address_.schema + "'")
            .c_str()));
  }

 private:
  std::unique_ptr<pqxx::connection> connected() const {
    return guarded(map_, [&] {
      char host[128] = {};
      gethostname(host, sizeof host - 1);
      const std::string name = "engram " + std::to_string(getpid()) + "@" + host;
      const char separator = address_.uri.find('?') == std::string::npos ? '?' : '&';
      std::string uri = address_.uri + separator + "application_name=";
      for (const char c : name) uri += c == ' ' || c == '@' ? '-' : c;
      return std::make_unique<pqxx::connection>(uri);
    });
  }

  /// The lock of the one who writes.
  void lock() {
    const std::string key = "hashtextextended('" + address_.schema + "', 0)";
    for (int i = 0; i < kLockTries; ++i) {  // a program that was killed a moment ago may seem to hold it
      if (work_->exec1("SELECT pg_try_advisory_lock(" + key + ")")[0].as<bool>()) return;
      usleep(kLockPause);
    }
    const pqxx::result holder = work_->exec(
        "SELECT a.application_name, coalesce(host(a.client_addr), 'this machine'), "
        "a.backend_start::timestamp(0) "
        "FROM pg_locks l JOIN pg_stat_activity a ON a.pid = l.pid WHERE l.locktype = 'advisory' AND "
        "l.granted AND "
        "(l.classid::BIGINT << 32 | l.objid::BIGINT) = " +
        key);
    std::string who = "another program";
    if (!holder.empty())
      who = std::string(holder[0][0].c_str()) + " from " + holder[0][1].c_str() + ", since " +
            holder[0][2].c_str();
    throw base::Error("map '" + map_ + "' is being written by " + who +
                      ". One program at a time may write a map: wait until it has ended, or stop it");
  }

  /// What the roles of a fleet may do, as far as the server has them.
  void grant(const std::string& schema) {
    const std::pair<const char*, const char*> rights[] = {
        {"engram_reader", "SELECT"},
        {"engram_robot", "SELECT, INSERT, UPDATE, DELETE"},
        {"engram_keeper", "ALL"},
    };
    for (const auto& [role, right] : rights) {
      const std::string is = "SELECT count(*) FROM pg_roles WHERE rolname = '" + std::string(role) + "'";
      if (number(is.c_str()) == 0) continue;
      execute(("GRANT USAGE ON SCHEMA " + schema + " TO " + role).c_str());
      execute(("GRANT " + std::string(right) + " ON ALL TABLES IN SCHEMA " + schema + " TO " + role).c_str());
    }
  }

  std::string map_;
  ServerAddress address_;
  ServerMode mode_;
  std::unique_ptr<pqxx::connection> connection_;
  std::unique_ptr<pqxx::nontransaction> work_;   // after the connection: it goes first
  std::map<std::string, std::string> prepared_;  // names by their SQL
  int process_ = 0;                              // of the server, for this connection
  std::uint64_t closedBytes_ = 0;
};

bool ServerCursor::step() {
  if (!result_) {
    result_ = server_.run(name_, parameters_);
    row_ = -1;
  }
  bytes_.clear();
  return ++row_ < static_cast<long>(result_->size());
}

/// Text as it is; bytes come in hexadecimal.
std::span<const std::uint8_t> ServerCursor::blob(int column) const {
  auto [known, isNew] = bytes_.try_emplace(column);
  if (isNew) {
    constexpr pqxx::oid kBytea = 17;
    const pqxx::field field = at(column);
    known->second = field.type() == kBytea
                        ? pqxx::binarystring(field).str()
                        : std::string(field.c_str(), static_cast<std::size_t>(field.size()));
  }
  return {reinterpret_cast<const std::uint8_t*>(known->second.data()), known->second.size()};
}

std::unique_ptr<Cursor> Server::prepare(const char* sql) {
  auto known = prepared_.find(sql);
  if (known == prepared_.end()) {
    const std::string name = "engram" + std::to_string(prepared_.size());
    guarded(map_, [&] { connection_->prepare(name, sql); });
    known = prepared_.emplace(sql, name).first;
  }
  return std::make_unique<ServerCursor>(*this, known->second);
}

}  // namespace

std::unique_ptr<Connection> connectToServer(const std::string& map, ServerMode mode) {
  return std::make_unique<Server>(map, mode);
}

bool existsOnServer(const std::string& map) {
  try {
    Server(map, ServerMode::kReadOnly);
    return true;
  } catch (const base::Error& e) {
    if (std::string(e.what()).ends_with("does not exist")) return false;
    throw;
  }
}

}  // namespace engram::store

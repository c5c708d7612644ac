// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

namespace engram::testing {

/// A PostgreSQL server of its own in a temporary folder, reached by a Unix socket there; nobody else sees it,
/// and it ends with this object. Root cannot run one: it is the user `postgres` of the Debian package then.
class PostgresServer {
 public:
  PostgresServer() {
    char name[] = "/tmp/engram_pg_XXXXXX";
    if (mkdtemp(name) == nullptr) return;
    folder_ = name;
    if (getuid() == 0 && std::system(("chown postgres " + folder_).c_str()) != 0) return;
    if (!run("initdb -D " + data() + " -A trust -U postgres -N -E UTF8 --locale=C")) return;
    started_ = start() && run("createdb -h " + folder_ + " -U postgres fleet");
  }
  ~PostgresServer() {
    if (replica_) run("pg_ctl -D " + folder_ + "/replica -m immediate stop");
    if (started_) run("pg_ctl -D " + data() + " -m immediate stop");
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  static bool installed() { return std::filesystem::exists(std::string(kPrograms) + "initdb"); }
  bool started() const { return started_; }
  bool start() {
    return run("pg_ctl -w -D " + data() + " -l " + folder_ + "/log -o \"-k " + folder_ +
               " -c listen_addresses='' -c fsync=off\" start");
  }
  /// A second server that follows this one, at the same socket with another port.
  bool startReplica() {
    replica_ = run("pg_basebackup -h " + folder_ + " -U postgres -R -c fast -D " + folder_ + "/replica") &&
               run("pg_ctl -w -D " + folder_ + "/replica -l " + folder_ + "/replica.log -o \"-p 5433 -k " +
                   folder_ + " -c listen_addresses='' -c fsync=off\" start");
    return replica_;
  }
  /// The replica becomes a primary.
  bool promote() { return run("pg_ctl -w -D " + folder_ + "/replica promote"); }
  std::string replicaOf(const std::string& map) const { return map + "&port=5433"; }
  bool stop() { return run("pg_ctl -w -D " + data() + " -m immediate stop"); }
  bool sql(const std::string& statement) {
    return run("psql -q -v ON_ERROR_STOP=1 -h " + folder_ + " -U postgres -d fleet -c \"" + statement + "\"");
  }

  std::string map(const std::string& name, const std::string& role = "postgres") const {
    return "postgresql:///fleet?host=" + folder_ + "&user=" + role + "&map=" + name;
  }

 private:
  static constexpr const char* kPrograms = "/usr/lib/postgresql/15/bin/";
  std::string data() const { return folder_ + "/data"; }
  bool run(const std::string& command) const {
    const std::string line = "cd /tmp && " + std::string(kPrograms) + command + " >/dev/null 2>&1";
    const std::string all = getuid() == 0 ? "runuser -u postgres -- sh -c '" + quoted(line) + "'"
                                          : "sh -c '" + quoted(line) + "'";
    return std::system(all.c_str()) == 0;
  }
  static std::string quoted(const std::string& line) {
    std::string out;
    for (const char c : line) {
      if (c == '\'')
        out += "'\\''";
      else
        out += c;
    }
    return out;
  }

  std::string folder_;
  bool started_ = false, replica_ = false;
};

}  // namespace engram::testing

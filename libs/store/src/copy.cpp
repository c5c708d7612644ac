// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "database.h"
#include "engram/base/error.h"
#include "engram/store/map_copy.h"
#include "engram/store/map_file.h"
#include "rows.h"
#include "schema.h"
#include "scratch.h"
#include "server.h"

#include <memory>

namespace engram::store {
namespace {

/// A damaged copy must not replace a good one.
void requireSoundCopy(const std::string& from, const std::string& copy) {
  const auto problems = MapFile::open(copy, Access::kReadOnly).check();
  if (!problems.empty())
    throw base::Error("map '" + from + "' is damaged: " + problems.front() +
                      ". It was not copied; save what can be read with 'engram-map recover'");
}

void copyBlobs(Connection& from, Connection& to, const std::string& table) {
  Statement read(from, ("SELECT id, data FROM " + table + " ORDER BY id").c_str());
  Statement write(to, ("INSERT INTO " + table + " VALUES ($1, $2)").c_str());
  while (read.step()) {
    const auto data = read.blob(1);
    const Blob row(data.begin(), data.end());
    write.bind(1, static_cast<std::uint64_t>(read.integer(0))).bind(2, row).run();
  }
}

void copyHeader(Connection& from, Connection& to) {
  Statement read(from, "SELECT key, value, crc FROM header");
  Statement write(to, "INSERT INTO header VALUES ($1, $2, $3)");
  while (read.step()) {
    const std::string key = read.text(0), value = read.text(1);
    write.bind(1, key).bind(2, value).bind(3, static_cast<std::uint64_t>(read.integer(2))).run();
  }
}

void copyRecords(Connection& from, Connection& to) {
  Statement read(from, "SELECT id, json, crc FROM records ORDER BY id");
  Statement write(to, "INSERT INTO records VALUES ($1, $2, $3)");
  while (read.step()) {
    const std::string json = read.text(1);
    write.bind(1, static_cast<std::uint64_t>(read.integer(0)))
        .bind(2, json)
        .bind(3, static_cast<std::uint64_t>(read.integer(2)))
        .run();
  }
}

void copyUndo(Connection& from, Connection& to) {
  Statement read(from, "SELECT kind, id, data FROM undo ORDER BY kind, id");
  Statement write(to, "INSERT INTO undo VALUES ($1, $2, $3)");
  while (read.step()) {
    const auto data = read.blob(2);
    const Blob row(data.begin(), data.end());
    write.bind(1, static_cast<std::uint64_t>(read.integer(0)))
        .bind(2, static_cast<std::uint64_t>(read.integer(1)))
        .bind(3, row)
        .run();
  }
}

/// Every row as it is, of one moment of `from`, into a map that is made, in one transaction.
void copyRows(Connection& from, Connection& to) {
  from.beginSnapshot();
  const int version = from.formatVersion();
  Transaction transaction(to);
  to.makeTables();
  copyHeader(from, to);
  for (const char* table : {"state", "places", "memories", "views", "edges", "path"})
    copyBlobs(from, to, table);
  copyRecords(from, to);
  if (version >= 2) {
    copyBlobs(from, to, "drives");
    copyUndo(from, to);
  } else {
    for (const Drive& drive : drivesFromRecords(from)) writeDrive(to, drive);
  }
  transaction.commit();
}

void copyToServer(const std::string& from, const std::string& to, bool overwrite) {
  if (!isOnServer(from)) requireSoundCopy(from, from);
  std::unique_ptr<Connection> source;
  if (isOnServer(from))
    source = connectToServer(from, ServerMode::kReadOnly);
  else
    source = std::make_unique<Database>(from, Database::Mode::kReadOnly);
  const auto target = connectToServer(to, overwrite ? ServerMode::kReplace : ServerMode::kCreate);
  copyRows(*source, *target);
  target->finish(true);
}

void copyFromServer(const std::string& from, const std::string& to, bool overwrite) {
  NewMap target(to, overwrite);
  {
    const auto source = connectToServer(from, ServerMode::kReadOnly);
    Database file(target.file(), Database::Mode::kCreate);
    copyRows(*source, file);
  }
  requireSoundCopy(from, target.file());
  target.publish();
}

}  // namespace

void copyMap(const std::string& from, const std::string& to, bool overwrite) {
  if (isOnServer(to)) return copyToServer(from, to, overwrite);
  if (isOnServer(from)) return copyFromServer(from, to, overwrite);
  requireSource(from, to);
  NewMap target(to, overwrite);
  copyContent(readablePath(from, target.scratch()), target.file());
  Database(target.file(), Database::Mode::kReadWrite).foldLog();
  requireSoundCopy(from, target.file());
  target.publish();
}

}  // namespace engram::store

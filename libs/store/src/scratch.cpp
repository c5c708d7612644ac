// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scratch.h"

#include "database.h"
#include "diagnosis.h"
#include "engram/base/error.h"
#include "schema.h"

#include <sqlite3.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <unistd.h>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCompanions[] = {"-wal", "-shm", "-journal"};

[[noreturn]] void cannotWrite(const std::string& path, const std::string& why) {
  throw base::Error("cannot write map '" + path + "': " + why);
}

/// Before the place is locked: the lock itself needs the folder.
const std::string& requireFolder(const std::string& path) {
  if (path.empty()) throw base::Error("the map needs a file name");
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) cannotWrite(path, "folder '" + folder.string() + "' does not exist");
  return path;
}

void requireReplaceable(const std::string& path, bool overwrite) {
  if (!fs::exists(fs::symlink_status(path))) return;
  if (!fs::is_regular_file(fs::symlink_status(path)) || !looksLikeMap(path))
    throw base::Error("'" + path + "' exists and is not an Engram map: it is not overwritten");
  if (!overwrite)
    throw base::Error("map '" + path + "' exists already. Overwrite it, or choose another name");
}

void syncFolder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

NewMap::NewMap(const std::string& path, bool overwrite) : path_(requireFolder(path)), lock_(path) {
  requireReplaceable(path, overwrite);
  std::string name = (fs::absolute(path).parent_path() / ".engram-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) cannotWrite(path, std::strerror(errno));
  folder_ = name;
}

NewMap::~NewMap() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

void NewMap::publish() {
  // The log of the old map goes first: beside the new one it would be taken for its own.
  std::error_code error;
  for (const char* companion : kCompanions)
    if (!fs::remove(path_ + companion, error) && error) cannotWrite(path_, error.message());
  fs::rename(file(), path_, error);
  if (error) cannotWrite(path_, error.message());
  syncFolder(folder_.parent_path());
}

void requireSource(const std::string& from, const std::string& to) {
  if (!fs::exists(from)) throw base::Error("map '" + from + "' does not exist");
  if (!fs::is_regular_file(from)) throw base::Error("map '" + from + "' is not a file");
  std::error_code none;
  if (fs::equivalent(from, to, none))
    throw base::Error("'" + to + "' is the map itself: choose another name");
}

void copyFiles(const std::string& from, const std::string& to) {
  const std::string real = realPath(from);
  std::error_code error;
  for (const char* part : {"", "-wal", "-journal"}) {
    if (part[0] != '\0' && !fs::exists(real + part)) continue;
    fs::copy_file(real + part, to + part, error);
    if (!error) fs::permissions(to + part, fs::perms::owner_read | fs::perms::owner_write, error);
    if (error) throw base::Error("cannot copy '" + from + part + "': " + error.message());
  }
}

std::string readablePath(const std::string& from, const std::string& scratch) {
  try {
    Database(from, Database::Mode::kReadOnly);
    return from;
  } catch (const base::Error&) {
    // A program that wrote it would have left the index of the log there.
    if (const std::string real = realPath(from); !fs::exists(real + "-wal") || fs::exists(real + "-shm"))
      throw;
  }
  copyFiles(from, scratch);
  return scratch;
}

void copyContent(const std::string& from, const std::string& to) {
  Database source(from, Database::Mode::kReadOnly);
  requireMap(source);
  Database target(to, Database::Mode::kCreate);
  const std::unique_ptr<sqlite3_backup, int (*)(sqlite3_backup*)> backup(
      sqlite3_backup_init(target.handle(), "main", source.handle(), "main"), sqlite3_backup_finish);
  if (!backup) target.fail(sqlite3_errcode(target.handle()));
  const int code = sqlite3_backup_step(backup.get(), -1);  // all at once: one moment of the source
  if (code != SQLITE_DONE) throw base::Error("map '" + from + "': " + explanation(code, errno, from));
}

}  // namespace engram::store

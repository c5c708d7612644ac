// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.h"

#include "database.h"
#include "engram/base/error.h"
#include "engram/store/map_copy.h"
#include "schema.h"
#include "server.h"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kHeadBytes = 108;  // the file header, and that of the first page

std::uint32_t bigEndian(const unsigned char* bytes, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return value;
}

bool folderIsReadOnly(const std::string& path) {
  return faccessat(AT_FDCWD, fs::absolute(path).parent_path().c_str(), W_OK, AT_EACCESS) != 0;
}

std::string logName(const std::string& path) {
  std::string name(1, '\'');
  name += realPath(path);
  return name += "-wal'";
}

std::string whyDamaged(const std::string& path) {
  const auto head = readHead(path);
  const std::string way = ". Use a copy of it, or save what can be read with 'engram-map recover'";
  if (head && head->bytes < head->declaredBytes)
    return "it is cut short: " + std::to_string(head->bytes) + " of " + std::to_string(head->declaredBytes) +
           " bytes. It was copied without its log " + logName(path) + ", or not to its end" + way;
  return "it is damaged" + way;
}

std::string whyNotOpened(int systemError, const std::string& system, const std::string& path) {
  if (fs::exists(realPath(path) + "-wal") && folderIsReadOnly(realPath(path)))
    return "the program that wrote it was cut off, and its log " + logName(path) +
           " can only be read in a folder that can be written. Copy it to such a folder with 'engram-map "
           "copy'";
  if (systemError == EACCES || systemError == EPERM)
    return "you may not read it, or not write where it is" + system;
  if (systemError == EMFILE || systemError == ENFILE) return "too many files are open" + system;
  return "it cannot be opened" + system + ". Does its folder exist, and may you read and write there?";
}

/// At most a page of zeros: the power failed before the first page was on the disk.
bool isBlank(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(kPageBytes + 1, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const auto read = static_cast<std::size_t>(in.gcount());
  return read <= kPageBytes && bytes.find_first_not_of('\0') == std::string::npos;
}

/// Whether the log beside an empty database holds a map.
bool logHoldsMap(const std::string& path) {
  try {
    Database database(path, Database::Mode::kReadOnly);
    return database.number("PRAGMA application_id") == kApplicationId;
  } catch (const base::Error&) {
    return false;
  }
}

}  // namespace

std::string realPath(const std::string& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(fs::absolute(path), error);
  return error ? path : real.string();
}

std::optional<FileHead> readHead(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<unsigned char, kHeadBytes> bytes{};
  in.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
  if (in.gcount() < 72 || std::memcmp(bytes.data(), "SQLite format 3", 16) != 0) return std::nullopt;
  FileHead head;
  std::error_code error;
  head.bytes = fs::file_size(path, error);
  const std::uint32_t page = bigEndian(bytes.data() + 16, 2);
  head.declaredBytes = std::uint64_t{page == 1 ? 65536 : page} * bigEndian(bytes.data() + 28, 4);
  head.logged = bytes[18] == 2 || bytes[19] == 2;
  head.applicationId = bigEndian(bytes.data() + 68, 4);
  head.hasTables = bytes[100] != 0x0D || bigEndian(bytes.data() + 103, 2) != 0;
  return head;
}

bool logIsMissing(const std::string& path) {
  const auto head = readHead(path);
  const std::string real = realPath(path);
  return head && head->logged && !fs::exists(real + "-wal") && !fs::exists(real + "-lock");
}

bool looksLikeMap(const std::string& path) {
  std::error_code error;
  if (fs::file_size(path, error) == 0) return !error;
  const auto head = readHead(path);
  if (!head) return isBlank(path);
  if (head->applicationId == kApplicationId) return true;
  // Nothing of a map whose making was cut off is in its file yet: there is nothing, or all of it is in the
  // log.
  const bool untouched = head->applicationId == 0 && !head->hasTables;
  const std::string log = realPath(path) + "-wal";
  return untouched && (!fs::exists(log) || fs::file_size(log) == 0 || logHoldsMap(path));
}

std::string explanation(int code, int systemError, const std::string& path) {
  const std::string system = systemError != 0 ? std::string(" (") + std::strerror(systemError) + ")" : "";
  switch (code & 0xff) {
    case SQLITE_FULL:
      return "the disk is full. Free some space; what was committed before is safe";
    case SQLITE_IOERR:
      if (code == SQLITE_IOERR_NOMEM) return explanation(SQLITE_NOMEM, 0, path);
      return "the disk cannot be read or written" + system + ". What was committed before is safe";
    case SQLITE_READONLY:
      if (code == SQLITE_READONLY_ROLLBACK || code == SQLITE_READONLY_RECOVERY ||
          code == SQLITE_READONLY_CANTINIT)
        return "its writer was interrupted and it must be repaired first. Run 'engram-map check' on it in a "
               "folder that can be written";
      return "it cannot be written: the file or its folder is read-only";
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return whyNotOpened(systemError, system, path);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program is writing it. Wait until it has ended";
    case SQLITE_PROTOCOL:
      return "too many programs open and close it at once, or its file system cannot lock files. Try again, "
             "on a local disk";
    case SQLITE_NOTADB:
      return whyNoMap(path);
    case SQLITE_NOMEM:
      return "the memory of this machine is used up. Nothing is wrong with the map; end other programs and "
             "try again";
    case SQLITE_TOOBIG:
      return "one of its rows is larger than a map may hold (256 MB)";
    case SQLITE_INTERRUPT:
    case SQLITE_ABORT:
      return "the work on it was interrupted. What was committed before is safe";
    case SQLITE_CONSTRAINT:
      return "a row that is there already was to be written again: a fault of this program. Nothing was "
             "changed; please report it";
    case SQLITE_CORRUPT:
    case SQLITE_ERROR:  // a table that must be there is not
      return whyDamaged(path);
    default:
      return std::string("SQLite refuses it (") + sqlite3_errstr(code) + ", code " + std::to_string(code) +
             ")" + system;
  }
}

std::string whyNoMap(const std::string& path) {
  if (logIsMissing(path) && looksLikeMap(path))
    return "there is nothing in it: it was copied without its log " + logName(path) + ". Copy both";
  return "it is not an Engram map";
}

std::string missingLog(const std::string& path) {
  if (isOnServer(path) || !logIsMissing(path)) return {};
  return "its last images may be missing: it was copied without " + logName(path) + ", or that was deleted";
}

}  // namespace engram::store

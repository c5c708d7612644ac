// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "faulty_vfs.h"

#include <sqlite3.h>

#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace engram::store::test {
namespace {

/// What SQLite sees as a file; the real one lies behind it in the same block of memory.
struct File {
  sqlite3_file base;
  FaultyVfs* vfs;
  const char* name;  ///< nullptr for temporary ones; lives as long as the file is open
  bool syncsFolder;  ///< at its first sync, as SQLite does it for new journals
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

File& of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }
FaultyVfs& of(sqlite3_vfs* vfs) { return *static_cast<FaultyVfs*>(vfs->pAppData); }
const sqlite3_io_methods& real(sqlite3_file* file) { return *of(file).real()->pMethods; }

void log(File& file, DiskEvent event) {
  if (file.name == nullptr) return;
  event.path = file.name;
  file.vfs->happened(std::move(event));
}

int closeFile(sqlite3_file* file) { return real(file).xClose(of(file).real()); }

int readFile(sqlite3_file* file, void* to, int size, sqlite3_int64 at) {
  if (of(file).vfs->fails(Call::kRead)) return SQLITE_IOERR_READ;
  return real(file).xRead(of(file).real(), to, size, at);
}

int writeFile(sqlite3_file* file, const void* from, int size, sqlite3_int64 at) {
  const bool fails = of(file).vfs->fails(Call::kWrite);
  const How how = of(file).vfs->how();
  if (fails) size = how == How::kError ? 0 : size / 2;
  if (size > 0) {
    const int code = real(file).xWrite(of(file).real(), from, size, at);
    if (code != SQLITE_OK) return code;
    const std::string bytes(static_cast<const char*>(from), static_cast<std::size_t>(size));
    log(of(file), {.kind = DiskEvent::Kind::kWrite, .at = at, .bytes = bytes});
  }
  if (!fails) return SQLITE_OK;
  return how == How::kFull ? SQLITE_FULL : SQLITE_IOERR_WRITE;
}

int truncateFile(sqlite3_file* file, sqlite3_int64 size) {
  if (of(file).vfs->fails(Call::kTruncate)) return SQLITE_IOERR_TRUNCATE;
  log(of(file), {.kind = DiskEvent::Kind::kTruncate, .at = size});
  return real(file).xTruncate(of(file).real(), size);
}

/// The disk of the log is the one that counts, so the real one need not be waited for.
int syncFile(sqlite3_file* file, int) {
  if (of(file).vfs->fails(Call::kSync)) return SQLITE_IOERR_FSYNC;
  log(of(file), {.kind = DiskEvent::Kind::kSync, .syncsFolder = of(file).syncsFolder});
  of(file).syncsFolder = false;
  return SQLITE_OK;
}

int mapShm(sqlite3_file* file, int page, int size, int extend, void volatile** to) {
  if (of(file).vfs->fails(Call::kShm)) return SQLITE_IOERR_SHMMAP;
  return real(file).xShmMap(of(file).real(), page, size, extend, to);
}

const sqlite3_io_methods kMethods = {
    .iVersion = 2,  // without mapping the file itself into memory
    .xClose = closeFile,
    .xRead = readFile,
    .xWrite = writeFile,
    .xTruncate = truncateFile,
    .xSync = syncFile,
    .xFileSize = [](sqlite3_file* f, sqlite3_int64* size) { return real(f).xFileSize(of(f).real(), size); },
    .xLock = [](sqlite3_file* f, int level) { return real(f).xLock(of(f).real(), level); },
    .xUnlock = [](sqlite3_file* f, int level) { return real(f).xUnlock(of(f).real(), level); },
    .xCheckReservedLock = [](sqlite3_file* f,
                             int* out) { return real(f).xCheckReservedLock(of(f).real(), out); },
    .xFileControl = [](sqlite3_file* f, int what,
                       void* arg) { return real(f).xFileControl(of(f).real(), what, arg); },
    .xSectorSize = [](sqlite3_file* f) { return real(f).xSectorSize(of(f).real()); },
    .xDeviceCharacteristics = [](sqlite3_file* f) { return real(f).xDeviceCharacteristics(of(f).real()); },
    .xShmMap = mapShm,
    .xShmLock = [](sqlite3_file* f, int at, int n,
                   int flags) { return real(f).xShmLock(of(f).real(), at, n, flags); },
    .xShmBarrier = [](sqlite3_file* f) { real(f).xShmBarrier(of(f).real()); },
    .xShmUnmap = [](sqlite3_file* f, int gone) { return real(f).xShmUnmap(of(f).real(), gone); },
    .xFetch = nullptr,
    .xUnfetch = nullptr,
};

int openFile(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* got) {
  file->pMethods = nullptr;
  FaultyVfs& faulty = of(vfs);
  if (faulty.fails(Call::kOpen)) return SQLITE_CANTOPEN;
  const bool isNew = name != nullptr && (flags & SQLITE_OPEN_CREATE) != 0 && !std::filesystem::exists(name);
  File& made = of(file);
  made.real()->pMethods = nullptr;
  const int code = faulty.real()->xOpen(faulty.real(), name, made.real(), flags, got);
  if (made.real()->pMethods == nullptr) return code;
  made.base.pMethods = &kMethods;
  made.vfs = &faulty;
  made.name = name;
  made.syncsFolder = isNew && (flags & (SQLITE_OPEN_WAL | SQLITE_OPEN_MAIN_JOURNAL)) != 0;
  if (isNew) log(made, {.kind = DiskEvent::Kind::kCreate});
  return code;
}

int deleteFile(sqlite3_vfs* vfs, const char* name, int syncFolder) {
  FaultyVfs& faulty = of(vfs);
  if (faulty.fails(Call::kDelete)) return SQLITE_IOERR_DELETE;
  const int code = faulty.real()->xDelete(faulty.real(), name, 0);
  if (code == SQLITE_OK)
    faulty.happened({.kind = DiskEvent::Kind::kDelete, .path = name, .syncsFolder = syncFolder != 0});
  return code;
}

sqlite3_mem_methods systemMemory;
std::uint64_t allocationsLeft;  // until the one that fails; 0 is never
bool failsForGood, memoryFired;

bool outOfMemory() {
  if (failsForGood && memoryFired) return true;
  if (allocationsLeft == 0 || --allocationsLeft > 0) return false;
  return memoryFired = true;
}

}  // namespace

const char* toString(Call call) {
  constexpr const char* kNames[kCalls] = {"open", "read", "write", "truncate", "sync", "delete", "shm"};
  return kNames[static_cast<std::size_t>(call)];
}

FaultyVfs::FaultyVfs() : real_(sqlite3_vfs_find(nullptr)), own_(new sqlite3_vfs(*real_)) {
  own_->zName = "faulty";
  own_->szOsFile = static_cast<int>(sizeof(File)) + real_->szOsFile;
  own_->pAppData = this;
  own_->xOpen = openFile;
  own_->xDelete = deleteFile;
  if (sqlite3_vfs_register(own_, 1) != SQLITE_OK) throw std::runtime_error("the VFS cannot be registered");
}

FaultyVfs::~FaultyVfs() {
  sqlite3_vfs_unregister(own_);
  sqlite3_vfs_register(real_, 1);
  delete own_;
}

bool FaultyVfs::fails(Call call) {
  const std::uint64_t n = ++calls_[static_cast<std::size_t>(call)];
  if (fault_.at == 0 || call != fault_.call) return false;
  const bool now = fault_.forGood ? n >= fault_.at : n == fault_.at;
  fired_ = fired_ || now;
  return now;
}

void FaultyVfs::happened(DiskEvent event) {
  if (event.kind == DiskEvent::Kind::kSync && watch_ && event.path == watched_) watch_();
  if (logs_) log_.push_back(std::move(event));
}

FaultyMemory::FaultyMemory() {
  sqlite3_shutdown();
  if (sqlite3_config(SQLITE_CONFIG_GETMALLOC, &systemMemory) != SQLITE_OK)
    throw std::runtime_error("SQLite's memory cannot be read");
  sqlite3_mem_methods own = systemMemory;
  own.xMalloc = [](int n) -> void* { return outOfMemory() ? nullptr : systemMemory.xMalloc(n); };
  own.xRealloc = [](void* p, int n) -> void* {
    return outOfMemory() ? nullptr : systemMemory.xRealloc(p, n);
  };
  arm(0, false);
  // Without the small reserve of each connection every allocation counts.
  if (sqlite3_config(SQLITE_CONFIG_MALLOC, &own) != SQLITE_OK ||
      sqlite3_config(SQLITE_CONFIG_LOOKASIDE, 0, 0) != SQLITE_OK || sqlite3_initialize() != SQLITE_OK)
    throw std::runtime_error("SQLite's memory cannot be replaced");
}

FaultyMemory::~FaultyMemory() {
  arm(0, false);
  sqlite3_shutdown();
  sqlite3_config(SQLITE_CONFIG_MALLOC, &systemMemory);
  sqlite3_initialize();
}

void FaultyMemory::arm(std::uint64_t at, bool forGood) {
  allocationsLeft = at;
  failsForGood = forGood;
  memoryFired = false;
}

bool FaultyMemory::fired() const { return memoryFired; }

}  // namespace engram::store::test

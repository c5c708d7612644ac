// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A file system and a memory for SQLite that fail when they are told to.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

struct sqlite3_vfs;

namespace engram::store::test {

enum class Call { kOpen, kRead, kWrite, kTruncate, kSync, kDelete, kShm };
inline constexpr std::size_t kCalls = 7;
const char* toString(Call call);

enum class How {
  kError,  ///< the call does nothing
  kShort,  ///< a write writes half of its bytes
  kFull,   ///< a write writes half of its bytes, and the disk is full
};

/// The `at`-th call of a kind fails, counted from 1; 0 is never.
struct Fault {
  Call call = Call::kWrite;
  std::uint64_t at = 0;
  bool forGood = false;  ///< and so do all later ones of that kind
  How how = How::kError;
};

/// Something that happened to a file, as a disk sees it.
struct DiskEvent {
  enum class Kind { kCreate, kDelete, kWrite, kTruncate, kSync } kind = Kind::kSync;
  std::string path{};
  std::int64_t at = 0;       ///< where a write begins; the new size of a truncation
  std::string bytes{};       ///< of a write
  bool syncsFolder = false;  ///< after it the names of all files are on the disk too
};

/// SQLite's default VFS while it lives: real files, but nothing waits for the disk. Not for several threads.
class FaultyVfs {
 public:
  FaultyVfs();
  ~FaultyVfs();
  FaultyVfs(const FaultyVfs&) = delete;
  FaultyVfs& operator=(const FaultyVfs&) = delete;

  void arm(const Fault& fault) { fault_ = fault; }
  bool fired() const { return fired_; }
  std::uint64_t calls(Call call) const { return calls_[static_cast<std::size_t>(call)]; }

  void keepLog() { logs_ = true; }
  /// Calls f at each sync of this file, with everything written. f may open other files.
  void watchSyncs(std::string path, std::function<void()> f) {
    watched_ = std::move(path), watch_ = std::move(f);
  }
  const std::vector<DiskEvent>& log() const { return log_; }

  /// Counts a call and says whether it shall fail.
  bool fails(Call call);
  How how() const { return fault_.how; }
  void happened(DiskEvent event);
  sqlite3_vfs* real() const { return real_; }

 private:
  Fault fault_;
  bool fired_ = false;
  bool logs_ = false;
  std::array<std::uint64_t, kCalls> calls_{};
  std::vector<DiskEvent> log_;
  std::string watched_;
  std::function<void()> watch_;
  sqlite3_vfs* real_;
  sqlite3_vfs* own_;
};

/// SQLite's allocator while it lives; no connection may be open when it begins or ends.
class FaultyMemory {
 public:
  FaultyMemory();
  ~FaultyMemory();
  FaultyMemory(const FaultyMemory&) = delete;
  FaultyMemory& operator=(const FaultyMemory&) = delete;

  /// The `at`-th allocation from now fails, counted from 1; 0 is never.
  void arm(std::uint64_t at, bool forGood);
  bool fired() const;
};

}  // namespace engram::store::test

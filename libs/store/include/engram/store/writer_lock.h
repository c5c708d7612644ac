// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace engram::store {

/// The right to write a map, for one program at a time, from the start of its run to the end. It is a lock of
/// the kernel on the file `<map>-lock`, so that it dies with its process.
class WriterLock {
 public:
  /// Throws base::Error when another program holds it (the message says which one, on which machine and since
  /// when), or when the folder cannot be written.
  explicit WriterLock(const std::string& mapPath);
  WriterLock(WriterLock&& other) noexcept;
  WriterLock& operator=(WriterLock&& other) noexcept;
  ~WriterLock();

  /// Whether some program holds the lock of this map.
  static bool isHeld(const std::string& mapPath);

  const std::string& mapPath() const { return mapPath_; }

 private:
  void release() noexcept;

  std::string mapPath_, lockPath_;
  int descriptor_ = -1;
};

}  // namespace engram::store

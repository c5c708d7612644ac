// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"

#include <string>
#include <string_view>

namespace engram::base {

/// As the path of an output: standard output.
inline constexpr const char* kStandardOutput = "-";

/// The reader of standard output has gone, as with `| head`.
class ClosedPipe : public Error {
 public:
  ClosedPipe() : Error("standard output: its reader has gone") {}
};

/// Throws base::Error when an output cannot be written there. Nothing that is there changes, so that it can
/// be asked before the work and not after it. An empty path is no output.
/// @param overwrite false: an existing file is an error too
void requireWritable(const std::string& path, bool overwrite = true);

/// The same for a folder that takes files; it must exist.
void requireWritableFolder(const std::string& folder);

/// False for what is written through and keeps nothing to be replaced: standard output, a device, a pipe.
bool isRegularOutput(const std::string& path);

/// Opens an output that grows while it is written, from its beginning; the caller closes the descriptor.
/// Links are followed; a new file is made only where nothing is. Throws base::Error.
int openOutput(const std::string& path, bool overwrite = true);

/// What went wrong, and what to do about it where the number tells.
std::string reasonOf(int errorNumber);

/// Writes every byte; returns 0 or the error number.
int writeAll(int descriptor, std::string_view bytes);

/// Waits until the file is on the disk; a pipe or device has no disk. Returns 0 or the error number.
int syncFile(int descriptor);

/// Waits until the names in the folder of this path are on the disk.
void syncFolderOf(const std::string& path);

/// When an output must be on the disk.
enum class Sync {
  kNow,   ///< before it gets its name
  kLater  ///< one of many files; syncDisk() follows them
};
/// Waits until all files are on the disk that holds this path; throws base::Error.
void syncDisk(const std::string& path);

/// A new name of its own in the folder of `path`, with the same ending. Nobody can guess it.
std::string temporaryBeside(const std::string& path);

/// An output that replaces an earlier file only when it is whole. Until then it is a temporary file beside
/// it, made exclusively. What is no regular file is never replaced: a device or pipe is written through, and
/// so is the file that standard output goes to. A link is followed: the file it names is replaced.
class OutputFile {
 public:
  /// Throws base::Error as requireWritable() does.
  OutputFile(std::string path, bool overwrite);
  /// Removes the temporary file unless commit() was called.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// Name of the temporary file; empty when written through.
  const std::string& temporary() const { return temporary_; }
  /// Throws base::Error; ClosedPipe for standard output.
  void write(std::string_view bytes);
  /// Gives the file its name. Throws base::Error.
  void commit(Sync sync = Sync::kNow);

 private:
  void giveName();

  std::string path_, target_, temporary_;
  int descriptor_ = -1;
  bool overwrite_ = false;
};

}  // namespace engram::base

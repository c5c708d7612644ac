// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace engram::sources {

/// The bytes of a file, gzip or not, through a window of fixed size. Not gzread(): that drops what it has
/// already decompressed when it meets damage, and everything before the damage is wanted.
class ByteStream {
 public:
  static constexpr std::size_t kWindow = 1 << 17;

  /// Throws base::Error when the file is missing, empty, a folder or unreadable.
  explicit ByteStream(const std::string& path);
  ~ByteStream();
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// At least `n` bytes (n <= kWindow) from the current position, fewer only at the end.
  std::span<const std::uint8_t> peek(std::size_t n);
  /// Steps over bytes that peek() has shown.
  void skip(std::size_t n);
  /// False when fewer than n bytes are left; they are consumed.
  bool read(void* to, std::size_t n);

  std::uint64_t position() const { return position_; }  ///< [bytes], after decompression
  double progress() const;                              ///< share of the file read, in [0, 1], never falls
  bool compressed() const { return inflater_ != nullptr; }
  /// Why no more bytes come although the file should hold more: a truncated or corrupt gzip stream, a read
  /// error.
  const std::string& error() const { return error_; }

 private:
  struct Inflater;
  void fill(std::size_t n);
  std::size_t readFile(std::uint8_t* to, std::size_t n);
  std::size_t inflateInto(std::uint8_t* to, std::size_t n);

  std::FILE* file_ = nullptr;
  std::unique_ptr<Inflater> inflater_;  // none for a file that is not compressed
  double size_ = 0.0;
  std::uint64_t consumed_ = 0;  // of the file
  std::vector<std::uint8_t> window_;
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t position_ = 0;
  bool atEnd_ = false;
  std::string error_;
};

}  // namespace engram::sources

// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace engram::store {

static_assert(std::endian::native == std::endian::little, "the map format is little-endian");

using Blob = std::vector<std::uint8_t>;

/// What a row is; a part of its checksum.
enum class RowKind : std::uint8_t {
  kState = 'S',
  kPlace = 'P',
  kMemory = 'M',
  kView = 'V',
  kEdge = 'E',
  kPath = 'T',
  kFeatures = 'F',
  kDrive = 'D',
  kCounts = 'N'
};

/// CRC-32 of zlib.
std::uint32_t crc32Of(std::span<const std::uint8_t> bytes);
std::uint32_t crc32Of(const std::string& text);

/// Builds a row: kind, version, fields, checksum.
class BlobWriter {
 public:
  BlobWriter(RowKind kind, std::uint8_t version) : bytes_{static_cast<std::uint8_t>(kind), version} {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { raw(&value, sizeof value); }
  void raw(const void* data, std::size_t size);
  void text(const std::string& s) {
    varint(s.size());
    raw(s.data(), s.size());
  }
  void varint(std::uint64_t value);
  std::size_t size() const { return bytes_.size(); }

  /// Huffman-codes everything after kind and version. Lossless; numbers of one kind should stand together.
  void compress();

  /// Appends the checksum over the content and the key of the row, so that swapped rows are found too.
  Blob seal(std::uint64_t rowId) &&;

 private:
  Blob bytes_;
};

/// Reads a sealed row. Every method throws base::Error rather than read beyond the end.
class BlobReader {
 public:
  /// Checks kind, version and checksum.
  BlobReader(std::span<const std::uint8_t> sealed, RowKind kind, std::uint8_t newestVersion,
             std::uint64_t rowId);

  std::uint8_t version() const { return version_; }

  template <class T>
  requires std::is_arithmetic_v<T> T get() {
    T value;
    raw(&value, sizeof value);
    return value;
  }
  void raw(void* data, std::size_t size);
  std::string text();
  /// Refuses numbers above `most`.
  std::uint64_t varint(std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
  /// 0 or 1.
  bool flag();
  /// A number of items that take at least `itemBytes` each: refused when the row is too short for them.
  std::size_t count(std::size_t itemBytes);
  /// Throws unless so many bytes are left: call it before an allocation.
  void require(std::size_t size) const;
  void requireEnd() const;
  /// What is left; to be copied before the row goes.
  std::span<const std::uint8_t> rest() const { return rest_; }

  /// Undoes BlobWriter::compress(); call it first.
  void decompress();

 private:
  std::uint8_t version_ = 0;
  std::span<const std::uint8_t> rest_;
  Blob decompressed_;
};

}  // namespace engram::store
